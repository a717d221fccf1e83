#include "vision/src/outline/appearance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "touchdown/core/units.h"
#include "touchdown/vision/synthetic/render.h"
#include "touchdown/vision/tracking/tracker.h"

namespace touchdown::vision {
namespace {

using namespace core::literals;  // NOLINT

// A body that flies slowly across a small picture, high above the ground.
Scene Flying(core::BodyKind kind) {
  Scene scene;
  scene.camera.width_px = 160;
  scene.camera.height_px = 100;
  scene.camera.ground_point = {20.0, 92.3};
  scene.camera.fps = 1000.0;
  scene.camera.bit_depth = 12;
  scene.frames = 60;
  scene.noise = {12.0, 0.0};
  scene.body = kind == core::BodyKind::kSphere
                   ? core::Sphere({0.020, 0.0})
                   : core::Rectangle({0.030, 0.0}, {0.014, 0.0});
  const double turn = kind == core::BodyKind::kSphere ? 0.0 : 6.0;
  scene.pose = [=](double t) {
    return ScenePose{{-0.045 + 3.6 * t, 0.035 + 0.6 * t - 9.0 * t * t},
                     0.2 + turn * t};
  };
  return scene;
}

struct Found {
  TrackResult tracked;
  Track refined;
};

std::optional<Found> Follow(const Scene& scene, std::uint64_t seed) {
  const auto clip = OpenScene(scene, seed);
  TrackOptions options;
  options.kind = scene.body.kind;
  auto result = TrackBody(*clip, options);
  if (!result) return std::nullopt;
  Track refined = Refine(*clip, result->background, result->track,
                         {TrueGroundLine(scene.camera), std::nullopt});
  return Found{std::move(*result), std::move(refined)};
}

// Outlines as they are.
std::vector<SeenOutline> TrueOutlines(const Scene& scene) {
  std::vector<SeenOutline> seen;
  for (std::int64_t i = 20; i < 50; ++i) {
    const SceneTruth truth = ComputeTruth(scene, i);
    SeenOutline one;
    one.frame = i;
    one.fit.outline.kind = scene.body.kind;
    one.fit.outline.centre = truth.centre;
    one.fit.outline.angle_rad = truth.image_angle_rad;
    if (scene.body.kind == core::BodyKind::kSphere) {
      one.fit.outline.radius_px = truth.radius_px;
    } else {
      one.fit.outline.half_long_px = 500.0 * scene.body.long_m->value;
      one.fit.outline.half_short_px = 500.0 * scene.body.short_m->value;
    }
    one.fit.blur_px =
        std::hypot(scene.camera.psf_sigma_px, std::sqrt(1.0 / 12));
    Shading shading;
    shading.level[0] = scene.look.body_level * 4095.0;
    one.fit.shading = shading;
    seen.push_back(one);
  }
  return seen;
}

class Appearances : public ::testing::TestWithParam<core::BodyKind> {};

TEST_P(Appearances, OfAPlainBodyThereIsNothingToLearn) {
  const Scene scene = Flying(GetParam());
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto clip = OpenScene(scene, seed);
    const auto result = TrackBody(*clip);
    ASSERT_TRUE(result);
    EXPECT_FALSE(
        LearnAppearance(*clip, result->background, TrueOutlines(scene), {}))
        << seed;
  }
}

TEST_P(Appearances, AHighlightIsLearntAsFarAsTheEdge) {
  Scene scene = Flying(GetParam());
  SceneTrouble& trouble = scene.trouble;
  trouble.highlight_level = 0.4;
  const auto clip = OpenScene(scene, 1);
  const auto result = TrackBody(*clip);
  ASSERT_TRUE(result);
  const auto look =
      LearnAppearance(*clip, result->background, TrueOutlines(scene), {});
  ASSERT_TRUE(look);
  EXPECT_EQ(look->spots.spots, 1);
  EXPECT_FALSE(look->turns);  // it stays where the lamp is
  const int half = GetParam() == core::BodyKind::kSphere ? 10 : 7;
  const double sigma = trouble.highlight_sigma * half;
  for (int y = -half; y <= half; ++y) {
    for (int x = -half; x <= half; ++x) {
      const double dx = (x - trouble.highlight_x * half) / sigma;
      const double dy = (y - trouble.highlight_y * half) / sigma;
      const double truth = 4095.0 * trouble.highlight_level *
                           std::exp(-0.5 * (dx * dx + dy * dy));
      const Appearance::Value value = look->At(x, y, 1.0, 0.0);
      // Half a per cent of the contrast is a hundredth of a pixel.
      EXPECT_NEAR(value.level_dn, truth, 10.0 + 4.0 * value.u_dn)
          << x << ", " << y;
    }
  }
}

// The oracle: sizes and centres, not how they were got.
TEST_P(Appearances, AHighlightDrawsNoOutlineAside) {
  for (const double level : {-0.1, 0.15, 0.45}) {
    Scene scene = Flying(GetParam());
    scene.trouble.highlight_level = level;
    scene.trouble.shading_x = 0.2;
    scene.trouble.shading_y = -0.3;
    const auto found = Follow(scene, 7);
    ASSERT_TRUE(found) << level;
    const BodyImage& body = found->refined.body;
    // Of 0.5 of contrast in 0.003 of noise; a highlight that is taken for edge
    // shifts it by a tenth of a pixel.
    constexpr double kGood_px = 0.012;
    if (GetParam() == core::BodyKind::kSphere) {
      EXPECT_NEAR(body.radius_px.value, 10.0, kGood_px) << level;
    } else {
      EXPECT_NEAR(body.half_long_px.value, 15.0, kGood_px) << level;
      EXPECT_NEAR(body.half_short_px.value, 7.0, kGood_px) << level;
    }
    double x = 0.0;
    double y = 0.0;
    for (const Pose& pose : found->refined.poses) {
      const SceneTruth truth = ComputeTruth(scene, pose.frame);
      x += pose.centre.x_px - truth.centre.x_px;
      y += pose.centre.y_px - truth.centre.y_px;
    }
    const auto n = static_cast<double>(found->refined.poses.size());
    EXPECT_GE(n, 30.0);
    EXPECT_NEAR(x / n, 0.0, kGood_px) << level;
    EXPECT_NEAR(y / n, 0.0, kGood_px) << level;
  }
}

// A shading and a change of size look alike: where the frames show none the
// size is known better, and it is right either way.
TEST(Appearance, AFlatFaceTellsTheSizeBetter) {
  const auto u_of_radius = [](double shading) {
    Scene scene = Flying(core::BodyKind::kSphere);
    scene.camera.psf_sigma_px = 1.4;
    scene.trouble.shading_x = shading;
    scene.trouble.shading_y = -shading;
    double sum = 0.0;
    constexpr std::uint64_t kSeeds = 8;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const auto found = Follow(scene, seed);
      EXPECT_TRUE(found);
      if (!found) continue;
      const core::Estimate& radius = found->refined.body.radius_px;
      EXPECT_NEAR(radius.value, 10.0, 3.0 * radius.u) << shading << ' ' << seed;
      sum += radius.u;
    }
    return sum / kSeeds;
  };
  EXPECT_LT(u_of_radius(0.0), 0.6 * u_of_radius(0.2));
}

// What comes in front of the body in some frames is none of its looks.
TEST_P(Appearances, AnObstacleIsNotLearnt) {
  Scene scene = Flying(GetParam());
  scene.trouble.obstacle = core::PixelRect{60, 30, 9, 70};
  scene.trouble.obstacle_level = 0.9;
  const auto clip = OpenScene(scene, 3);
  const auto result = TrackBody(*clip);
  ASSERT_TRUE(result);
  EXPECT_FALSE(
      LearnAppearance(*clip, result->background, TrueOutlines(scene), {}));
}

INSTANTIATE_TEST_SUITE_P(Kinds, Appearances,
                         ::testing::Values(core::BodyKind::kSphere,
                                           core::BodyKind::kRectangle),
                         [](const auto& kind) {
                           return kind.param == core::BodyKind::kSphere
                                      ? std::string("Sphere")
                                      : std::string("Rectangle");
                         });

}  // namespace
}  // namespace touchdown::vision
