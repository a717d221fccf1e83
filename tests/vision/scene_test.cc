#include "touchdown/vision/synthetic/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "touchdown/core/units.h"

namespace touchdown::vision {
namespace {

using namespace core::literals;  // NOLINT

Scene SphereScene() {
  Scene scene;
  scene.body = core::Sphere({40.0_mm, 0.0});
  scene.pose = [](double) { return ScenePose{{0.010, 0.030}, 0.0}; };
  return scene;
}

TEST(Scene, PlaneToImageIsASimilarityThatMirrorsForTravelToTheLeft) {
  SceneCamera camera;
  camera.ground_point = {100.0, 300.0};
  camera.px_per_m = 2000.0;
  EXPECT_EQ(ToImage(camera, {0.0, 0.0}), camera.ground_point);
  EXPECT_NEAR(ToImage(camera, {0.01, 0.02}).x_px, 120.0, 1e-12);
  EXPECT_NEAR(ToImage(camera, {0.01, 0.02}).y_px, 260.0, 1e-12);
  camera.travels_left = true;
  EXPECT_NEAR(ToImage(camera, {0.01, 0.02}).x_px, 80.0, 1e-12);
  EXPECT_NEAR(ToImage(camera, {0.01, 0.02}).y_px, 260.0, 1e-12);
  // Rolled by 30 degrees the ground falls to the right.
  camera.travels_left = false;
  camera.roll_rad = 30.0_deg;
  const auto along = ToImage(camera, {0.01, 0.0});
  EXPECT_NEAR(along.x_px, 100.0 + 20.0 * std::cos(30.0_deg), 1e-12);
  EXPECT_NEAR(along.y_px, 300.0 + 20.0 * std::sin(30.0_deg), 1e-12);
}

TEST(Scene, GroundLineIsTheImageOfThePlanesZero) {
  for (const bool left : {false, true}) {
    for (const double roll : {-5.0_deg, 0.0, 12.0_deg}) {
      SceneCamera camera;
      camera.travels_left = left;
      camera.roll_rad = roll;
      const calib::GroundLine ground = TrueGroundLine(camera);
      EXPECT_NEAR(calib::ImageAngle(ground), roll, 1e-12);
      for (const double x : {-0.2, 0.0, 0.13}) {
        for (const double y : {0.0, 0.05}) {
          EXPECT_NEAR(calib::HeightAboveLine(ground, ToImage(camera, {x, y})),
                      1000.0 * y, 1e-9);
        }
      }
      EXPECT_EQ(ground.u_offset_px, 0.0);
      EXPECT_EQ(ground.u_angle_rad, 0.0);
    }
  }
}

TEST(Scene, GapIsTheLowestOutlinePoint) {
  const core::Body sphere = core::Sphere({40.0_mm, 0.0});
  EXPECT_NEAR(Gap(sphere, {{1.0, 0.025}, 0.7}), 0.005, 1e-15);
  const core::Body block = core::Rectangle({40.0_mm, 0.0}, {20.0_mm, 0.0});
  EXPECT_NEAR(Gap(block, {{0.0, 0.010}, 0.0}), 0.0, 1e-15);
  const double tilt = 25.0_deg;
  const double lowest = 0.02 * std::sin(tilt) + 0.01 * std::cos(tilt);
  EXPECT_NEAR(Gap(block, {{0.0, 0.05}, tilt}), 0.05 - lowest, 1e-15);
  EXPECT_NEAR(Gap(block, {{0.0, 0.05}, -tilt}), 0.05 - lowest, 1e-15);
}

TEST(Scene, PositiveAngleLiftsTheLeadingEnd) {
  const core::Body block = core::Rectangle({40.0_mm, 0.0}, {20.0_mm, 0.0});
  const auto corners = Corners(block, {{0.0, 0.05}, 10.0_deg});
  EXPECT_GT(corners[0].x_m, corners[1].x_m);  // leading, trailing
  EXPECT_GT(corners[0].y_m, corners[1].y_m);
}

TEST(Scene, TruthIsTheMiddleOfTheExposure) {
  Scene scene = SphereScene();
  scene.pose = [](double t) { return ScenePose{{2.0 * t, 0.03}, 0.1 * t}; };
  const SceneTruth truth = ComputeTruth(scene, 7);
  EXPECT_DOUBLE_EQ(truth.time_s, 7.0 / 2000.0);
  EXPECT_NEAR(truth.centre.x_px, 320.0 + 7.0, 1e-12);
  EXPECT_NEAR(truth.centre.y_px, 300.0, 1e-12);
  EXPECT_NEAR(truth.radius_px, 20.0, 1e-12);
  EXPECT_NEAR(truth.gap_px, 10.0, 1e-12);
}

TEST(Scene, ImageAngleFollowsRollAndMirror) {
  Scene scene = SphereScene();
  scene.body = core::Rectangle({40.0_mm, 0.0}, {20.0_mm, 0.0});
  scene.pose = [](double) { return ScenePose{{0.0, 0.05}, 10.0_deg}; };
  for (const bool left : {false, true}) {
    scene.camera.travels_left = left;
    scene.camera.roll_rad = 3.0_deg;
    const SceneTruth truth = ComputeTruth(scene, 0);
    const auto corners = Corners(scene.body, truth.pose);
    const auto lead = ToImage(scene.camera, corners[0]);
    const auto trail = ToImage(scene.camera, corners[1]);
    const double seen =
        std::atan((lead.y_px - trail.y_px) / (lead.x_px - trail.x_px));
    EXPECT_NEAR(truth.image_angle_rad, seen, 1e-12) << "left " << left;
  }
}

TEST(Scene, ImpossibleScenesAreRefusedByName) {
  const auto complaint = [](auto&& spoil) -> std::string {
    Scene scene = SphereScene();
    spoil(scene);
    try {
      Validate(scene);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  using testing::HasSubstr;
  EXPECT_EQ(complaint([](Scene&) {}), "accepted");
  EXPECT_THAT(complaint([](Scene& s) { s.camera.fps = 0.0; }),
              HasSubstr("camera.fps is 0, must be positive"));
  EXPECT_THAT(complaint([](Scene& s) { s.camera.exposure_s = 1e-3; }),
              HasSubstr("camera.exposure_s"));
  EXPECT_THAT(complaint([](Scene& s) { s.camera.psf_sigma_px = 0.05; }),
              HasSubstr("camera.psf_sigma_px"));
  EXPECT_THAT(complaint([](Scene& s) { s.camera.bit_depth = 17; }),
              HasSubstr("camera.bit_depth"));
  EXPECT_THAT(complaint([](Scene& s) { s.look.body_level = 1.5; }),
              HasSubstr("look.body_level"));
  EXPECT_THAT(complaint([](Scene& s) {
                s.noise.read_dn = std::numeric_limits<double>::quiet_NaN();
              }),
              HasSubstr("noise.read_dn"));
  EXPECT_THAT(complaint([](Scene& s) { s.pose = nullptr; }), HasSubstr("pose"));
  EXPECT_THAT(complaint([](Scene& s) { s.body = core::Body{}; }),
              HasSubstr("body.diameter_m"));
}

}  // namespace
}  // namespace touchdown::vision
