// Turns of a face that a test draws, against the angles it was drawn at.
#include "vision/src/layers/disc_turn.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/vision/layered_scene.h"
#include "vision/src/layers/fit_layers.h"

namespace touchdown::vision::layers {
namespace {

// A dark ball with marks that falls, strikes at picture 14, and spins the other
// way.
LayeredScene SpinningBall() {
  LayeredScene scene;
  scene.shape = Shape{true, 11.0, 11.0};
  scene.body = [](double u, double v) {
    return 60.0 + 18.0 * std::sin(0.7 * u + 0.4) * std::cos(0.5 * v) +
           (std::hypot(u - 4.0, v + 3.0) < 2.5 ? 40.0 : 0.0);
  };
  for (int t = 0; t < 30; ++t) {
    const double after = std::max(0, t - 14);
    scene.poses.push_back({20.0 + 1.9 * t, 18.0 + 1.1 * t - 1.8 * after,
                           0.17 * t - 0.41 * after});
  }
  return scene;
}

TEST(FindTurns, OfAFaceBeforeAndAfterABlow) {
  const LayeredScene scene = SpinningBall();
  const auto turns =
      FindTurns(Film(scene, 3), scene.shape, 1.0, 1.0, scene.poses);
  ASSERT_TRUE(turns);
  ASSERT_EQ(turns->size(), scene.poses.size());
  EXPECT_EQ(turns->front(), 0.0);
  for (std::size_t t = 0; t < turns->size(); ++t) {
    EXPECT_NEAR((*turns)[t], scene.poses[t].angle_rad, 0.03) << t;
  }
}

TEST(FindTurns, OfAFaceThatTurnsByAThirdBetweenTwoPictures) {
  LayeredScene scene = SpinningBall();
  for (std::size_t t = 0; t < scene.poses.size(); ++t) {
    scene.poses[t].angle_rad = 2.0 * static_cast<double>(t);
  }
  const auto turns =
      FindTurns(Film(scene, 3), scene.shape, 1.0, 1.0, scene.poses);
  ASSERT_TRUE(turns);
  for (std::size_t t = 0; t < turns->size(); ++t) {
    EXPECT_NEAR((*turns)[t], scene.poses[t].angle_rad, 0.03) << t;
  }
}

TEST(FindTurns, OfPicturesThatDoNotShowAllOfTheFaceByTheOthers) {
  LayeredScene scene = SpinningBall();
  for (LayerPose& pose : scene.poses) pose.x -= 18.0;
  const auto turns =
      FindTurns(Film(scene, 3), scene.shape, 1.0, 1.0, scene.poses);
  ASSERT_TRUE(turns);
  for (std::size_t t = 1; t < turns->size(); ++t) {
    EXPECT_NEAR((*turns)[t] - (*turns)[0],
                scene.poses[t].angle_rad - scene.poses[0].angle_rad, 0.04)
        << t;
  }
}

TEST(MeasureFaceChange, IsNoiseUnlessMarksTurn) {
  LayeredScene scene = SpinningBall();
  const auto change = [&] {
    return MeasureFaceChange(Film(scene, 3), scene.shape, 1.0, scene.poses);
  };
  EXPECT_GT(change(), 50.0);
  for (LayerPose& pose : scene.poses) pose.angle_rad = 0.0;
  EXPECT_LT(change(), 2.0);
}

TEST(FindTurns, NotOfAFaceThatKeepsItsAngle) {
  LayeredScene scene = SpinningBall();
  for (LayerPose& pose : scene.poses) pose.angle_rad = 0.0;
  EXPECT_FALSE(FindTurns(Film(scene, 3), scene.shape, 1.0, 1.0, scene.poses));
}

TEST(FindTurns, NotOfAFaceWithoutMarks) {
  LayeredScene scene = SpinningBall();
  scene.body = [](double, double) { return 60.0; };
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
    EXPECT_FALSE(
        FindTurns(Film(scene, seed), scene.shape, 1.0, 1.0, scene.poses))
        << seed;
  }
}

TEST(FindTurns, NotOfADiscTooSmallToShowAFace) {
  LayeredScene scene = SpinningBall();
  scene.shape = Shape{true, 4.0, 4.0};
  EXPECT_FALSE(FindTurns(Film(scene, 3), scene.shape, 1.0, 1.0, scene.poses));
}

TEST(FitLayers, AFaceThatTurnsDoesNotDrawABallAside) {
  const LayeredScene scene = SpinningBall();
  const PictureStack stack = Film(scene, 9);
  FitLayersOptions options;
  options.prior.value[kBlur] = 1.0;
  options.prior.u[kBlur] = 0.5;
  options.prior.value[kLong] = options.prior.value[kShort] =
      scene.shape.half_long;
  options.prior.u[kSlopeX] = options.prior.u[kSlopeY] = 20.0;
  for (std::size_t k = 0; k < kTerms; ++k)
    options.prior.u[kQuadratic + k] = 1e4;
  options.textured = true;
  options.threads = 1;
  const auto worst = [&](bool turns) {
    options.turns = turns;
    std::vector<LayerPose> start = scene.poses;
    const auto angles = FindTurns(stack, scene.shape, 1.0, 1.0, start);
    for (std::size_t t = 0; t < start.size(); ++t) {
      start[t].angle_rad = turns ? (*angles)[t] : 0.0;
    }
    const LayerFit fit = FitLayers(stack, scene.shape, start,
                                   Paint(scene, nullptr), 1.0, options);
    double most = 0.0;
    for (std::size_t t = 0; t < start.size(); ++t) {
      most = std::max({most, std::abs(fit.poses[t].x - scene.poses[t].x),
                       std::abs(fit.poses[t].y - scene.poses[t].y)});
      if (!turns) continue;
      EXPECT_NEAR(fit.poses[t].angle_rad, scene.poses[t].angle_rad, 0.02);
    }
    return most;
  };
  EXPECT_LT(worst(true), 0.04);
  EXPECT_GT(worst(false), 0.08);
}

}  // namespace
}  // namespace touchdown::vision::layers
