// One Gauss-Newton step in all unknowns together: its products, and the coarse
// space of its preconditioner (layered_scene.h paints the frames).
#include "vision/src/layers/normal_equations.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tests/vision/layered_scene.h"
#include "vision/src/layers/joint_step.h"

namespace touchdown::vision::layers {
namespace {

// A block with a strong texture that falls past a shaded wall. It does not
// turn: a slope of the light looks as a slope of its own picture.
LayeredScene TexturedBlock() {
  LayeredScene scene;
  scene.still = [](double x, double y) { return 150.0 + 0.3 * x + 0.2 * y; };
  scene.body = [](double x, double y) {
    return 90.0 + 30.0 * std::sin(0.9 * x + 0.4 * y) + 20.0 * std::cos(1.1 * y);
  };
  for (int t = 0; t < 10; ++t) {
    scene.poses.push_back({22.3 + 4.7 * t, 24.0 + 1.3 * t, 0.05});
  }
  return scene;
}

// The normal equations of that scene, from poses that are off.
struct Equations {
  LayeredScene scene = TexturedBlock();
  PictureStack stack;
  Layers layers;
  std::vector<FrameSamples> frames;
  std::vector<LayerPose> poses = scene.poses;
  StillEvidence evidence;
  JointStepOptions options;

  explicit Equations(unsigned seed = 31, double off_px = 0.1)
      : stack(Film(scene, seed)) {
    layers.shape = scene.shape;
    layers.blur = 1.0;
    layers.flat = false;
    layers.still = Paint(scene, nullptr);
    layers.grid = PictureGrid(scene.shape, 6.0);
    for (std::int32_t j = 0; j < layers.grid.rows(); ++j) {
      for (std::int32_t i = 0; i < layers.grid.columns(); ++i) {
        layers.picture.push_back(static_cast<float>(
            scene.body(static_cast<double>(layers.grid.x_of(i)),
                       static_cast<double>(layers.grid.y_of(j)))));
      }
    }
    layers.grid.TransformLevels(layers.picture.data());
    layers.noise_dn = 1.0;
    layers.texture.deviation_dn = 20.0;
    for (LayerPose& pose : poses) pose.x += off_px;
    const std::vector<LayerPose> motions = EstimateMotions(poses, stack.frames);
    for (std::size_t t = 0; t < poses.size(); ++t) {
      Linearize(stack, t, layers, poses[t], motions[t], Derivatives::kAll,
                frames.emplace_back());
    }
    evidence = WeighStill(stack, layers, frames, 1);
    options.prior.value = {1.0, 0.09, scene.shape.half_long,
                           scene.shape.half_short};
    options.prior.u = {0.5, 0.2, 0.0, 0.0, 20.0, 20.0};
    options.least_chi2 = 0.0;
    options.most_products = 1000;
    options.threads = 1;
  }
};

TEST(NormalEquations, StiffnessOfTheCoarseSpaceIsThatOfProducts) {
  const Equations at;
  SharedPrior prior = at.options.prior;
  prior.u.fill(1.0);
  const CoarseSpace none;
  NormalEquations equations(at.layers, at.frames, at.evidence, prior, true,
                            none, 1);
  Unknowns right = equations.Zero();
  equations.Fill(right);
  const CoarseSpace coarse = equations.FindCoarseSpace(at.poses);
  for (int d = 0; d < kDirections; ++d) {
    const auto column = static_cast<Eigen::Index>(d);
    Unknowns direction = equations.Zero();
    coarse.Prolong(Eigen::VectorXd::Unit(kDirections, column), direction);
    Unknowns product = equations.Zero();
    equations.Multiply(direction, product);
    Eigen::VectorXd stiffness = coarse.Restrict(product);
    if (d < kQuadratic) stiffness[column] -= 1.0;  // of what is known
    for (Eigen::Index b = 0; b < stiffness.size(); ++b) {
      EXPECT_NEAR(coarse.stiffness(b, column), stiffness[b],
                  2e-3 * std::sqrt(coarse.stiffness(b, b) *
                                   coarse.stiffness(column, column)))
          << d << ' ' << b;
    }
  }
}

// At the same tolerance: what pixels tell little of is solved first, not last.
TEST(JointStep, ACoarseSpaceIsNearerAndCostsNoProducts) {
  const Equations at;
  const CoarseSpace coarse =
      FindCoarseSpace(at.layers, at.frames, at.evidence, at.poses, at.options);
  const auto solve = [&](const CoarseSpace& space, double tolerance) {
    JointStepOptions options = at.options;
    options.tolerance = tolerance;
    return SolveJointStep(at.layers, at.frames, at.evidence, space, options);
  };
  constexpr double kTolerance = 3e-4;
  const JointStep plain = solve(CoarseSpace(), kTolerance);
  const JointStep step = solve(coarse, kTolerance);
  const JointStep exact = solve(CoarseSpace(), 1e-5);
  EXPECT_LE(step.products, plain.products);
  EXPECT_LT(step.products, 60);
  const auto off = [&](const JointStep& of) {
    return std::abs(of.poses[0].y - exact.poses[0].y);
  };
  EXPECT_LT(2.0 * off(step), off(plain));
  for (std::size_t t = 0; t < at.poses.size(); ++t) {
    EXPECT_NEAR(step.poses[t].x, exact.poses[t].x, 2e-3) << t;
    EXPECT_NEAR(step.poses[t].y, exact.poses[t].y, 2e-3) << t;
  }
  EXPECT_NEAR(step.shared[kBlur], exact.shared[kBlur], 2e-3);
}

// Against the scatter of the common place over frames of other noise: the step
// from the truth. A texture hides it, so it is far above what scatter of the
// poses would leave of a mean.
TEST(JointStep, WhatFramesShareIsAsUncertainAsItScatters) {
  constexpr int kDraws = 24;
  double square_x = 0.0;
  double square_y = 0.0;
  double square_angle = 0.0;
  double mean_long = 0.0;  // of the drawing's own picture at the rim
  double square_long = 0.0;
  CommonUncertainty stated;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Equations at(100U + static_cast<unsigned>(draw), 0.0);
    JointStepOptions options = at.options;
    options.prior.u[kLong] = 0.3;
    options.tolerance = 1e-3;
    const CoarseSpace coarse =
        FindCoarseSpace(at.layers, at.frames, at.evidence, at.poses, options);
    stated = MeasureCommonUncertainty(at.layers, at.frames, at.evidence, coarse,
                                      at.poses, options);
    const JointStep step =
        SolveJointStep(at.layers, at.frames, at.evidence, coarse, options);
    const double angle = at.poses[0].angle_rad;  // of all
    double x = 0.0;
    double y = 0.0;
    double turn = 0.0;
    for (const LayerPose& pose : step.poses) {
      const auto n = static_cast<double>(step.poses.size());
      x += (pose.x * std::cos(angle) + pose.y * std::sin(angle)) / n;
      y += (pose.y * std::cos(angle) - pose.x * std::sin(angle)) / n;
      turn += pose.angle_rad / n;
    }
    square_x += x * x / kDraws;
    square_y += y * y / kDraws;
    square_angle += turn * turn / kDraws;
    mean_long += step.shared[kLong] / kDraws;
    square_long += step.shared[kLong] * step.shared[kLong] / kDraws;
  }
  // The prior's part of u is not drawn here: at most as large. 24 draws leave
  // a seventh.
  EXPECT_LT(std::sqrt(square_x), 1.4 * stated.x_px);
  EXPECT_LT(std::sqrt(square_y), 1.4 * stated.y_px);
  EXPECT_LT(std::sqrt(square_angle), 1.4 * stated.angle_rad);
  const double scatter_long = std::sqrt(square_long - mean_long * mean_long);
  EXPECT_LT(scatter_long, 1.4 * stated.long_px);
  EXPECT_GT(scatter_long, 0.2 * stated.long_px);
  EXPECT_GT(std::sqrt(square_x), 0.2 * stated.x_px);
  EXPECT_GT(std::sqrt(square_y), 0.2 * stated.y_px);
}

}  // namespace
}  // namespace touchdown::vision::layers
