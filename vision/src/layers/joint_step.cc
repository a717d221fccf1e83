#include "layers/joint_step.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace touchdown::vision::layers {

CoarseSpace FindCoarseSpace(const Layers& layers,
                            const std::vector<FrameSamples>& frames,
                            const StillEvidence& evidence,
                            const std::vector<LayerPose>& poses,
                            const JointStepOptions& options) {
  const CoarseSpace none;
  NormalEquations equations(layers, frames, evidence, options.prior,
                            options.turns, none, options.threads);
  Unknowns right = equations.Zero();
  equations.Fill(right);
  return equations.FindCoarseSpace(poses);
}

namespace {

// x of A x = b by conjugate gradients; `residual` is b, and what is left of it.
// How many products it took.
int SolveEquations(NormalEquations& equations, const JointStepOptions& options,
                   double noise_dn, Unknowns& residual, Unknowns& x) {
  Unknowns scaled = x;
  equations.Precondition(residual, scaled);
  Unknowns direction = scaled;
  Unknowns product = x;
  double power = residual.Dot(scaled);
  const double goal = std::max(power * options.tolerance * options.tolerance,
                               options.least_chi2 * noise_dn * noise_dn);
  int products = 0;
  while (products < options.most_products && power > goal) {
    equations.Multiply(direction, product);
    ++products;
    const double along = direction.Dot(product);
    if (!(along > 0.0)) break;
    const double length = power / along;
    x.Add(length, direction);
    residual.Add(-length, product);
    equations.Precondition(residual, scaled);
    const double next = residual.Dot(scaled);
    direction.TurnTo(scaled, next / power);
    power = next;
  }
  return products;
}

}  // namespace

CommonUncertainty MeasureCommonUncertainty(
    const Layers& layers, const std::vector<FrameSamples>& frames,
    const StillEvidence& evidence, const CoarseSpace& coarse,
    const std::vector<LayerPose>& poses, const JointStepOptions& options) {
  NormalEquations equations(layers, frames, evidence, options.prior,
                            options.turns, coarse, options.threads);
  Unknowns unused = equations.Zero();
  equations.Fill(unused);
  JointStepOptions solve = options;
  solve.least_chi2 = 0.0;
  const auto uncertainty = [&](const Unknowns& w) {
    Unknowns residual = w;
    Unknowns solution = equations.Zero();
    SolveEquations(equations, solve, layers.noise_dn, residual, solution);
    return layers.noise_dn * std::sqrt(std::max(0.0, w.Dot(solution)));
  };
  // Axis `k` of all poses, turned with each.
  const auto of_axis = [&](std::size_t k) {
    Unknowns mean = equations.Zero();
    for (std::size_t t = 0; t < poses.size(); ++t) {
      const Eigen::Matrix3d axes =
          Eigen::AngleAxisd(poses[t].angle_rad, Eigen::Vector3d::UnitZ())
              .toRotationMatrix();
      for (std::size_t a = 0; a < kPose; ++a) {
        mean.poses[kPose * t + a] =
            axes(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(k)) /
            static_cast<double>(poses.size());
      }
    }
    return uncertainty(mean);
  };
  const auto of_side = [&](SharedParameter side) {
    if (!(options.prior.u[side] > 0.0)) return 0.0;
    Unknowns one = equations.Zero();
    one.shared[side] = 1.0;
    return uncertainty(one);
  };
  CommonUncertainty u;
  u.x_px = of_axis(0);
  u.y_px = of_axis(1);
  if (options.turns) u.angle_rad = of_axis(2);
  u.long_px = of_side(kLong);
  u.short_px = of_side(kShort);
  return u;
}

JointStep SolveJointStep(const Layers& layers,
                         const std::vector<FrameSamples>& frames,
                         const StillEvidence& evidence,
                         const CoarseSpace& coarse,
                         const JointStepOptions& options) {
  NormalEquations equations(layers, frames, evidence, options.prior,
                            options.turns, coarse, options.threads);
  Unknowns residual = equations.Zero();
  equations.Fill(residual);
  Unknowns step = equations.Zero();
  JointStep out;
  out.products =
      SolveEquations(equations, options, layers.noise_dn, residual, step);
  for (std::size_t t = 0; t < frames.size(); ++t) {
    out.poses.push_back({step.poses[kPose * t], step.poses[kPose * t + 1],
                         step.poses[kPose * t + 2]});
  }
  out.shared = step.shared;
  out.picture = std::move(step.picture);
  out.still.resize(layers.still.size());
  for (std::size_t x = 0; x < out.still.size(); ++x) {
    out.still[x] = evidence.residual[x] / (evidence.weight[x] + kLeastStill);
  }
  const ShownPixels& shown = equations.shown();
  for (std::size_t i = 0; i < shown.size(); ++i) {
    out.still[shown.pixel[i]] = step.still[i];
  }
  return out;
}

}  // namespace touchdown::vision::layers
