// The frame's derivatives by all that the two-layer model has, against
// differences of the model (layered_scene.h paints the frames).
#include "vision/src/layers/layer_model.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "tests/vision/layered_scene.h"
#include "vision/src/layers/body_picture.h"

namespace touchdown::vision::layers {
namespace {

// Layers of a scene with a shaded body.
Layers ShadedLayers(const LayeredScene& scene) {
  Layers layers;
  layers.shape = scene.shape;
  layers.blur = 0.95;
  layers.still = Paint(scene, nullptr);
  layers.grid = PictureGrid(scene.shape, 6.0);
  layers.picture.assign(layers.grid.size(), 0.0F);
  layers.quadratic = {60.0, 3.0, -2.0, 1.0, 0.0, 2.0};
  layers.noise_dn = 1.0;
  return layers;
}

// How steep a derivative is for `change`, the model's own by pixel: 1 where
// they agree. Of the whole, not pixel by pixel: second derivatives are left out
// beside edges of the scene.
double Agreement(const FrameSamples& at, const std::vector<float>& derivative,
                 const std::vector<double>& change) {
  double product = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (at.cover[i] < 0.01F) continue;
    const double by = change[static_cast<std::size_t>(at.pixel[i])];
    product += by * static_cast<double>(derivative[i]);
    square += by * by;
  }
  return product / square;
}

TEST(Linearize, DerivativesByThePoseAreThoseOfTheModel) {
  const LayeredScene scene = BlockOnGround();
  const PictureStack stack = Film(scene, 29);
  const Layers layers = ShadedLayers(scene);
  const LayerPose pose = scene.poses[10];
  const LayerPose motion{1.37, 0.9, 0.01};
  FrameSamples at;
  Linearize(stack, 10, layers, pose, motion, Derivatives::kAll, at);
  constexpr double kStep = 0.02;
  const auto residual_at = [&](double dx, double dy, double turn) {
    std::vector<double> residual(stack.pixels());
    FrameSamples moved;
    Linearize(stack, 10, layers,
              {pose.x + dx, pose.y + dy, pose.angle_rad + turn}, motion,
              Derivatives::kByPose, moved);
    for (std::size_t i = 0; i < moved.size(); ++i) {
      residual[static_cast<std::size_t>(moved.pixel[i])] =
          static_cast<double>(moved.residual[i]);
    }
    return residual;
  };
  const double turn = kStep / scene.shape.Reach();
  const std::array<std::array<std::vector<double>, 2>, 3> ends = {
      {{residual_at(kStep, 0, 0), residual_at(-kStep, 0, 0)},
       {residual_at(0, kStep, 0), residual_at(0, -kStep, 0)},
       {residual_at(0, 0, turn), residual_at(0, 0, -turn)}}};
  for (std::size_t a = 0; a < 3; ++a) {
    std::vector<double> change;
    for (std::size_t x = 0; x < stack.pixels(); ++x) {
      change.push_back((ends[a][1][x] - ends[a][0][x]) /
                       (2.0 * (a == 2 ? turn : kStep)));
    }
    EXPECT_NEAR(Agreement(at, at.by_pose[a], change), 1.0, 0.03) << a;
  }
}

// Also of one so short that a single place would do for the picture.
TEST(Linearize, DerivativeByTheExposureIsThatOfTheModel) {
  const LayeredScene scene = BlockOnGround();
  const PictureStack stack = Film(scene, 29);
  Layers layers = ShadedLayers(scene);
  for (const double exposure : {0.1, 0.6}) {
    const auto linearize = [&](double square) {
      layers.exposure = std::sqrt(square);
      FrameSamples at;
      Linearize(stack, 10, layers, scene.poses[10], {1.37, 0.9, 0.01},
                Derivatives::kAll, at);
      return at;
    };
    const double square = exposure * exposure;
    const double step = 0.2 * square;
    const FrameSamples at = linearize(square);
    const FrameSamples less = linearize(square - step);
    const FrameSamples more = linearize(square + step);
    std::vector<double> change(stack.pixels());
    for (std::size_t i = 0; i < less.size(); ++i) {
      change[static_cast<std::size_t>(less.pixel[i])] +=
          static_cast<double>(less.residual[i]);
    }
    for (std::size_t i = 0; i < more.size(); ++i) {
      change[static_cast<std::size_t>(more.pixel[i])] -=
          static_cast<double>(more.residual[i]);
    }
    for (double& by : change) by /= 2.0 * step;
    EXPECT_NEAR(Agreement(at, at.by_shared[kExposureSquare], change), 1.0, 0.05)
        << exposure;
  }
}

// Where two nodes of the exposure share one place, to second order of the way
// between them; of more nodes to rounding.
TEST(Linearize, DerivativeByThePictureIsThatOfTheModel) {
  const LayeredScene scene = BlockOnGround();
  const PictureStack stack = Film(scene, 29);
  Layers layers = ShadedLayers(scene);
  LearnTexture(layers);
  std::mt19937_64 engine(43);
  std::uniform_real_distribution<float> draw(-1.0F, 1.0F);
  std::vector<float> change(layers.picture.size());
  for (float& value : change) value = draw(engine);
  struct Case {
    double exposure;
    std::size_t places;  // of a pixel
    double error;        // of the derivative, as a share of it
  };
  for (const Case& c : {Case{0.1, 1, 0.0035}, Case{0.6, 1, 36.0 * 0.0035},
                        Case{0.95, 3, 1e-4}}) {
    layers.exposure = c.exposure;
    const double pace = c.places == 1 ? 1.0 : 2.0;
    const auto linearize = [&](const std::vector<float>& picture) {
      Layers of = layers;
      of.picture = picture;
      FrameSamples at;
      Linearize(stack, 10, of, scene.poses[10],
                {1.37 * pace, 0.9 * pace, 0.01 * pace}, Derivatives::kAll, at);
      return at;
    };
    const FrameSamples before = linearize(layers.picture);
    std::vector<float> changed = layers.picture;
    for (std::size_t i = 0; i < changed.size(); ++i) changed[i] += change[i];
    const FrameSamples after = linearize(changed);
    ASSERT_EQ(before.nodes, c.places);
    ASSERT_EQ(before.size(), after.size());
    double square = 0.0;
    double error = 0.0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      float by = 0.0F;
      for (std::size_t k = 0; k < before.nodes; ++k) {
        const std::size_t at = i * before.nodes + k;
        by += before.share[at] * layers.grid.EvaluateSpline(
                                     change.data(), before.place[at],
                                     PictureGrid::WeighPlace(before.place[at]));
      }
      const auto is = static_cast<double>(before.residual[i]) -
                      static_cast<double>(after.residual[i]);
      square += is * is;
      error += (is - static_cast<double>(by)) * (is - static_cast<double>(by));
    }
    EXPECT_LT(std::sqrt(error / square), c.error) << c.exposure;
  }
}

// Where a pixel sees the body alone, a pose and the picture that move together
// change nothing. Where derivatives said otherwise, joint steps would hold both
// where they are.
TEST(Linearize, PoseAndPictureMoveTogether) {
  const LayeredScene scene = BlockOnGround();
  const PictureStack stack = Film(scene, 29);
  Layers layers = ShadedLayers(scene);
  LearnTexture(layers);
  for (std::size_t c = 0; c < layers.picture.size(); ++c) {
    layers.picture[c] += 20.0F * std::sin(0.7F * static_cast<float>(c));
  }
  for (const double exposure : {0.6, 0.95}) {
    layers.exposure = exposure;
    const LayerPose& pose = scene.poses[10];
    FrameSamples at;
    Linearize(stack, 10, layers, pose, {2.74, 1.8, 0.0}, Derivatives::kAll, at);
    const double cosine = std::cos(pose.angle_rad);
    const double sine = std::sin(pose.angle_rad);
    double square = 0.0;
    double left = 0.0;
    for (std::size_t i = 0; i < at.size(); ++i) {
      if (at.cover[i] < 0.9999F) continue;
      double by = 0.0;  // a shift of T along the body's x
      for (std::size_t k = 0; k < at.nodes; ++k) {
        const std::size_t node = i * at.nodes + k;
        by += static_cast<double>(
            at.share[node] *
            layers.grid.EvaluateTilt(layers.picture.data(), at.place[node])
                .by_x);
      }
      const double of_pose = cosine * static_cast<double>(at.by_pose[0][i]) +
                             sine * static_cast<double>(at.by_pose[1][i]);
      square += by * by;
      left += (by + of_pose) * (by + of_pose);
    }
    EXPECT_GT(square, 0.0);
    EXPECT_LT(std::sqrt(left / square), 2e-3) << exposure << ' ' << at.nodes;
  }
}

}  // namespace
}  // namespace touchdown::vision::layers
