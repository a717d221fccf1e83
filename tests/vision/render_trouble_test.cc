// touchdown/vision/scene_trouble.h as it is drawn: each trouble alone against
// its closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>

#include "touchdown/core/units.h"
#include "touchdown/vision/render.h"

namespace touchdown::vision {
namespace {

// A disc of 20 px at (80, 50), its lowest point 10 px above the ground line.
Scene Plain() {
  Scene scene;
  scene.body = core::Sphere({0.04, 0.0});
  scene.pose = [](double) { return ScenePose{{0.0, 0.03}, 0.0}; };
  scene.camera.width_px = 160;
  scene.camera.height_px = 120;
  scene.camera.ground_point = {80.0, 80.0};
  return scene;
}

double Change(const Scene& scene, std::int32_t x, std::int32_t y,
              std::int64_t index = 0) {
  return (static_cast<double>(RenderClean(scene, index).at(x, y)) -
          static_cast<double>(RenderClean(Plain(), index).at(x, y))) /
         255.0;
}

TEST(RenderTrouble, ShadingIsLinearAcrossTheBody) {
  Scene scene = Plain();
  scene.trouble.shading_x = 0.4;
  scene.trouble.shading_y = -0.2;
  const double level = scene.look.body_level;
  EXPECT_NEAR(Change(scene, 80, 50), 0.0, 1e-6);
  EXPECT_NEAR(Change(scene, 90, 50), level * 0.4 * 0.5, 1e-6);
  EXPECT_NEAR(Change(scene, 80, 60), level * -0.2 * 0.5, 1e-6);
  EXPECT_NEAR(Change(scene, 20, 20), 0.0, 1e-9);  // not of the body
}

TEST(RenderTrouble, HighlightIsGaussian) {
  Scene scene = Plain();
  scene.trouble.highlight_level = 0.3;
  scene.trouble.highlight_x = 0.0;
  scene.trouble.highlight_y = 0.0;
  scene.trouble.highlight_sigma = 0.2;  // 4 px
  EXPECT_NEAR(Change(scene, 80, 50), 0.3, 1e-6);
  EXPECT_NEAR(Change(scene, 84, 50), 0.3 * std::exp(-0.5), 1e-6);
}

// Darkest under the body, nothing above the ground, paler from higher up.
TEST(RenderTrouble, ShadowLiesOnTheGround) {
  Scene scene = Plain();
  scene.trouble.shadow_depth = 0.5;
  const double under = Change(scene, 80, 84);
  EXPECT_LT(under, -0.05);
  EXPECT_GT(Change(scene, 120, 84), 0.5 * under);
  EXPECT_NEAR(Change(scene, 80, 74), 0.0, 1e-6);
  Scene higher = scene;
  higher.pose = [](double) { return ScenePose{{0.0, 0.05}, 0.0}; };
  Scene plain = Plain();
  plain.pose = higher.pose;
  const double from_higher =
      (static_cast<double>(RenderClean(higher, 0).at(80, 84)) -
       static_cast<double>(RenderClean(plain, 0).at(80, 84))) /
      255.0;
  EXPECT_LT(std::abs(from_higher), 0.9 * std::abs(under));
}

TEST(RenderTrouble, FlickerIsASine) {
  Scene scene = Plain();
  scene.trouble.flicker_amplitude = 0.1;
  scene.trouble.flicker_hz = 100.0;
  for (const std::int64_t index : {0, 3, 5, 11}) {
    const double t = static_cast<double>(index) / scene.camera.fps;
    EXPECT_NEAR(Change(scene, 10, 10, index),
                scene.look.background_level * 0.1 *
                    std::sin(2.0 * std::numbers::pi * 100.0 * t),
                1e-5);
  }
}

// The area under the edge over whole waves is that of the straight line.
TEST(RenderTrouble, WaveGoesUpAndDown) {
  Scene scene = Plain();
  scene.trouble.wave_amplitude_px = 2.0;
  scene.trouble.wave_length_px = 40.0;
  const SceneRenderer wavy(scene);
  const SceneRenderer straight(Plain());
  double sum = 0.0;
  for (std::int32_t x = 0; x < 160; ++x) {
    for (std::int32_t y = 70; y < 90; ++y) {
      sum += static_cast<double>(wavy.background().at(x, y)) -
             static_cast<double>(straight.background().at(x, y));
    }
  }
  const double one_px =
      255.0 * (scene.look.ground_level - scene.look.background_level);
  EXPECT_NEAR(sum / one_px / 160.0, 0.0, 0.02);
  // A quarter wave beyond the reference point the edge is 2 px higher.
  const auto edge = [&](std::int32_t x) {
    double ground = 0.0;
    for (std::int32_t y = 60; y < 100; ++y) {
      ground += (static_cast<double>(wavy.background().at(x, y)) / 255.0 -
                 scene.look.background_level) /
                (scene.look.ground_level - scene.look.background_level);
    }
    return 99.5 - ground;
  };
  EXPECT_NEAR(edge(90), 78.0, 0.05);
  EXPECT_NEAR(edge(110), 82.0, 0.05);
}

TEST(RenderTrouble, SpecksMoveAndComeBack) {
  Scene scene = Plain();
  scene.pose = [](double) { return ScenePose{{9.0, 9.0}, 0.0}; };
  Scene plain = scene;
  scene.trouble.specks = 4;
  scene.trouble.speck_diameter_px = 4.0;
  const auto area = [&](std::int64_t index) {
    const CleanImage with = RenderClean(scene, index);
    const CleanImage without = RenderClean(plain, index);
    double changed = 0.0;
    for (std::int32_t y = 0; y < 78; ++y) {
      for (std::int32_t x = 0; x < 160; ++x) {
        changed += static_cast<double>(with.at(x, y) - without.at(x, y));
      }
    }
    return changed / 255.0 /
           (scene.look.body_level - scene.look.background_level);
  };
  double most = 0.0;
  for (std::int64_t index = 0; index < 400; index += 20) {
    most = std::fmax(most, area(index));
  }
  const double four = 4.0 * std::numbers::pi * 4.0;
  EXPECT_LT(most, 1.01 * four);
  EXPECT_GT(most, 0.45 * four);
}

TEST(RenderTrouble, ObstacleHidesTheBody) {
  Scene scene = Plain();
  scene.trouble.obstacle = core::PixelRect{75, 0, 10, 120};
  scene.trouble.obstacle_level = 0.3;
  const CleanImage image = RenderClean(scene, 0);
  EXPECT_NEAR(static_cast<double>(image.at(79, 50)), 0.3 * 255.0, 1e-3);
  EXPECT_NEAR(static_cast<double>(image.at(79, 10)), 0.3 * 255.0, 1e-3);
  EXPECT_NEAR(Change(scene, 65, 50), 0.0, 1e-6);
}

TEST(RenderTrouble, RefusedByName) {
  const auto refused = [](auto set) {
    Scene scene = Plain();
    set(scene.trouble);
    try {
      Validate(scene);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refused([](SceneTrouble& t) {
              t.shadow_depth = 1.5;
            }).find("shadow_depth"),
            std::string::npos);
  EXPECT_NE(refused([](SceneTrouble& t) { t.specks = -1; }).find("specks"),
            std::string::npos);
  EXPECT_NE(refused([](SceneTrouble& t) {
              t.wave_length_px = 0.0;
            }).find("wave_length_px"),
            std::string::npos);
  EXPECT_EQ(refused([](SceneTrouble&) {}), "");
}

}  // namespace
}  // namespace touchdown::vision
