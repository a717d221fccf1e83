// touchdown/vision/synthetic/scene_trouble.h as it is drawn: each trouble alone
// against its closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>

#include "touchdown/core/units.h"
#include "touchdown/vision/synthetic/render.h"

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

// --- camera and body
// ----------------------------------------------------------

struct Moments {
  double area = 0.0;  // px, of full scale
  double x = 0.0;
  double y = 0.0;
};

// Of what `scene` has and `without` has not.
Moments MomentsOf(const Scene& scene, const Scene& without,
                  std::int64_t index = 0) {
  const CleanImage a = RenderClean(scene, index);
  const CleanImage b = RenderClean(without, index);
  Moments m;
  for (std::int32_t y = 0; y < a.height_px; ++y) {
    for (std::int32_t x = 0; x < a.width_px; ++x) {
      const double d =
          (static_cast<double>(a.at(x, y)) - static_cast<double>(b.at(x, y))) /
          255.0;
      m.area += d;
      m.x += d * x;
      m.y += d * y;
    }
  }
  m.x /= m.area;
  m.y /= m.area;
  return m;
}

Scene Empty(Scene scene) {
  scene.pose = [](double) { return ScenePose{{9.0, 9.0}, 0.0}; };
  return scene;
}

TEST(RenderBody, TheMarkTurnsWithIt) {
  for (const double angle : {0.0, 0.7, 3.0}) {
    Scene scene = Plain();
    scene.pose = [angle](double) { return ScenePose{{0.0, 0.03}, angle}; };
    const Scene without = scene;
    scene.look.mark = SceneMark{0.9, 0.5, 0.3};
    const Moments m = MomentsOf(scene, without);
    EXPECT_NEAR(m.area, std::numbers::pi * 36.0 * (0.9 - scene.look.body_level),
                1e-2);
    EXPECT_NEAR(m.x, 80.0 + 10.0 * std::cos(angle), 1e-3);
    EXPECT_NEAR(m.y, 50.0 - 10.0 * std::sin(angle), 1e-3);
  }
}

TEST(RenderBody, TheHoleShowsWhatIsBehind) {
  Scene scene = Plain();
  // Over the ground's edge.
  scene.pose = [](double) { return ScenePose{{0.0, 0.0}, 0.0}; };
  const Scene whole = scene;
  scene.look.hole = 0.6;
  const SceneRenderer ring(scene);
  const CleanImage image = ring.RenderClean(0);
  for (const std::int32_t y : {72, 80, 88}) {
    EXPECT_NEAR(image.at(80, y), ring.background().at(80, y), 1e-3) << y;
  }
  EXPECT_NEAR(image.at(80, 64), 255.0 * scene.look.body_level, 1e-3);
  const double half = 0.5 * std::numbers::pi * 144.0;
  EXPECT_NEAR(MomentsOf(scene, whole).area,
              half * (scene.look.background_level + scene.look.ground_level -
                      2.0 * scene.look.body_level),
              2e-2);
}

// Of a falling disc row y shows where it was when that row was read: y0 + v t y
// for the point y0, which makes it higher by 1 / (1 - v t) and moves it.
TEST(RenderCamera, ARollingShutterStretchesWhatFalls) {
  Scene scene = Plain();
  scene.camera.exposure_s = 0.0;
  scene.camera.row_delay_s = 4e-6;
  constexpr double kSpeed_mps = 5.0;  // 0.02 px a row
  scene.pose = [](double t) {
    return ScenePose{{0.0, 0.045 - kSpeed_mps * t}, 0.0};
  };
  const double share = 1000.0 * kSpeed_mps * scene.camera.row_delay_s;
  const Moments m = MomentsOf(scene, Empty(scene));
  const double contrast = scene.look.body_level - scene.look.background_level;
  // The blur is not stretched: the area is right to the edge's share in it.
  EXPECT_NEAR(m.area, contrast * std::numbers::pi * 400.0 / (1.0 - share), 0.1);
  EXPECT_NEAR(m.x, 80.0, 1e-3);
  EXPECT_NEAR(m.y, 35.0 / (1.0 - share), 2e-3);
}

// One that passes is sheared: each row's middle is where it then was.
TEST(RenderCamera, ARollingShutterShearsWhatPasses) {
  Scene scene = Plain();
  scene.camera.exposure_s = 0.0;
  scene.camera.row_delay_s = 4e-6;
  constexpr double kSpeed_mps = 10.0;
  scene.pose = [](double t) { return ScenePose{{kSpeed_mps * t, 0.035}, 0.0}; };
  const SceneRenderer renderer(scene);
  const CleanImage image = renderer.RenderClean(0);
  for (const std::int32_t y : {32, 45, 58}) {
    double sum = 0.0;
    double first = 0.0;
    for (std::int32_t x = 0; x < 160; ++x) {
      const double d = static_cast<double>(image.at(x, y)) -
                       static_cast<double>(renderer.background().at(x, y));
      sum += d;
      first += d * x;
    }
    EXPECT_NEAR(first / sum,
                80.0 + 1000.0 * kSpeed_mps * scene.camera.row_delay_s * y,
                1e-3);
  }
}

// The plane turned by 10 degrees about the ground point, 1 m away: a pinhole's
// arithmetic.
Scene Turned() {
  Scene scene = Plain();
  scene.camera.lens =
      calib::Lens{1000.0, 1000.0, 70.0, 40.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  scene.camera.yaw_rad = 10.0 * core::kDegree;
  return scene;
}

core::PixelPoint PinholeOf(double x_m, double y_m) {
  const double yaw = 10.0 * core::kDegree;
  const double depth = 1.0 + x_m * std::sin(yaw);
  return {70.0 + 1000.0 * (0.01 + x_m * std::cos(yaw)) / depth,
          40.0 + 1000.0 * (0.04 - y_m) / depth};
}

TEST(RenderCamera, YawIsAPinholes) {
  for (const double x : {-0.03, 0.0, 0.04}) {
    Scene scene = Turned();
    scene.pose = [x](double) { return ScenePose{{x, 0.03}, 0.2}; };
    const core::PixelPoint seen = ToImage(scene.camera, {x, 0.03});
    EXPECT_NEAR(seen.x_px, PinholeOf(x, 0.03).x_px, 1e-9);
    EXPECT_NEAR(seen.y_px, PinholeOf(x, 0.03).y_px, 1e-9);
    const Moments disc = MomentsOf(scene, Empty(scene));
    const double radius = 20.0 / (1.0 + x * std::sin(10.0 * core::kDegree));
    const double contrast = scene.look.body_level - scene.look.background_level;
    EXPECT_NEAR(disc.x, seen.x_px, 2e-3);
    EXPECT_NEAR(disc.y, seen.y_px, 2e-3);
    EXPECT_NEAR(disc.area, contrast * std::numbers::pi * radius * radius, 0.05);
    EXPECT_NEAR(ComputeTruth(scene, 0).radius_px, radius, 1e-9);
    scene.body = core::Rectangle({0.04, 0.0}, {0.02, 0.0});
    // Its image's area by the shoelace formula over the pinhole's corners.
    double area = 0.0;
    const auto corners = Corners(scene.body, scene.pose(0.0));
    for (std::size_t k = 0; k < 4; ++k) {
      const auto p = PinholeOf(corners[k].x_m, corners[k].y_m);
      const auto q =
          PinholeOf(corners[(k + 1) % 4].x_m, corners[(k + 1) % 4].y_m);
      area += 0.5 * (p.x_px * q.y_px - q.x_px * p.y_px);
    }
    EXPECT_NEAR(MomentsOf(scene, Empty(scene)).area, contrast * std::abs(area),
                0.05);
  }
  const auto ground = TrueGroundLine(Turned().camera);
  for (const double x : {-0.05, 0.05}) {
    EXPECT_NEAR(calib::HeightAboveLine(ground, PinholeOf(x, 0.0)), 0.0, 1e-9);
  }
}

TEST(RenderCamera, RefusesWhatItCannotDraw) {
  Scene scene = Turned();
  scene.camera.lens.reset();
  EXPECT_THROW(Validate(scene), std::invalid_argument);
  scene = Plain();
  scene.camera.row_delay_s = 1e-3;
  EXPECT_THROW(Validate(scene), std::invalid_argument);
  scene.camera.row_delay_s = 1e-6;
  EXPECT_NO_THROW(Validate(scene));
  scene.trouble.shading_x = 0.1;
  EXPECT_THROW(Validate(scene), std::invalid_argument);
  scene = Plain();
  scene.look.mark = SceneMark{0.9, 0.8, 0.3};
  EXPECT_THROW(Validate(scene), std::invalid_argument);
  scene.look.mark = SceneMark{0.9, 0.7, 0.2};
  scene.look.hole = 0.6;
  EXPECT_THROW(Validate(scene), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::vision
