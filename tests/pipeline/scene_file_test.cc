#include "app/simulate/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

using testing::HasSubstr;

// The text of a scene, with one piece of it replaced.
std::string With(const std::string& from, const std::string& to) {
  std::string text = R"({
    "schema": "touchdown.scene/1",
    "frames": 120,
    "lead_in_frames": 40,
    "body": {"kind": "rectangle", "long_mm": 40, "short_mm": 20},
    "thrown": {"mu": 0.3, "restitution": 0.5,
               "touchdown": {"frame": 70.25, "speed_mps": 1.5,
                             "approach_angle_deg": 25, "x_mm": 3,
                             "angle_deg": -12, "omega_rad_per_s": 2}},
    "camera": {"fps": 1000, "travels": "left", "bit_depth": 12}
  })";
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string Complaint(const std::string& text) {
  try {
    (void)ParseScene(text, "shot.json");
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SceneFile, TouchdownIsReachedAsWritten) {
  const Shot shot = ParseScene(With("{", "{"), "shot.json");
  const ShotTruth truth = ComputeTruth(shot);
  ASSERT_TRUE(truth.touchdown.has_value());
  const analysis::TouchdownTruth& t = *truth.touchdown;
  EXPECT_NEAR(t.time_s, 0.07025, 1e-12);
  EXPECT_NEAR(t.approach_angle_rad, 25.0 * core::kDegree, 1e-12);
  EXPECT_NEAR(std::hypot(t.before.vx_mps, t.before.vy_mps), 1.5, 1e-12);
  EXPECT_NEAR(*t.face_angle_rad, -12.0 * core::kDegree, 1e-12);
  EXPECT_NEAR(t.before.centre.x_m, 0.003, 1e-12);
  EXPECT_EQ(t.corner, core::Corner::kLeading);
  EXPECT_TRUE(shot.camera.travels_left);
  EXPECT_EQ(shot.camera.bit_depth, 12);
  EXPECT_EQ(shot.camera.height_px, 400);  // default
  EXPECT_EQ(shot.angle_kind, core::AngleKind::kRadius);
}

TEST(SceneFile, WrittenAndReadBackItIsTheSameShot) {
  for (const Shot& shot :
       {ExampleShot(), ParseScene(With("{", "{"), "shot.json"),
        Table1Shots()[0], Table1Shots()[12]}) {
    const Shot back = ParseScene(SceneText(shot), "back");
    EXPECT_EQ(back.name, shot.name);
    EXPECT_EQ(back.frames, shot.frames);
    EXPECT_EQ(back.lead_in_frames, shot.lead_in_frames);
    EXPECT_EQ(back.look.texture_seed, shot.look.texture_seed);
    const ShotTruth a = ComputeTruth(shot);
    const ShotTruth b = ComputeTruth(back);
    EXPECT_EQ(a.state, b.state);
    EXPECT_NEAR(a.touchdown->time_s, b.touchdown->time_s, 1e-12);
    EXPECT_EQ(a.touchdown->from_start, b.touchdown->from_start);
    EXPECT_NEAR(a.touchdown->approach_angle_rad,
                b.touchdown->approach_angle_rad, 1e-10);
    // Rounding of degrees and millimetres grows from bounce to bounce.
    EXPECT_NEAR(a.greatest.gap_m, b.greatest.gap_m, 1e-9);
  }
}

TEST(SceneFile, ExampleIsTwentyDegreesAndABounce) {
  const ShotTruth truth = ComputeTruth(ExampleShot());
  EXPECT_NEAR(truth.touchdown->approach_angle_rad, 20.0 * core::kDegree, 1e-12);
  EXPECT_EQ(truth.state, core::MotionState::kBounce);
  const double rise = std::pow(0.5 * 1.5 * std::sin(20.0 * core::kDegree), 2) /
                      (2.0 * core::kStandardGravity_mps2);
  EXPECT_NEAR(truth.greatest.gap_m, rise, 1e-9);
}

TEST(SceneFile, MistakesAreNamedByFileAndPath) {
  EXPECT_EQ(Complaint(With("{", "{")), "accepted");
  EXPECT_THAT(Complaint("{]"), HasSubstr("shot.json: is not JSON"));
  EXPECT_THAT(Complaint("[]"), HasSubstr("shot.json: / must be an object"));
  EXPECT_THAT(Complaint(With("scene/1", "scene/9")),
              HasSubstr("shot.json: /schema is 'touchdown.scene/9'"));
  EXPECT_THAT(Complaint(With("\"mu\"", "\"my\"")),
              HasSubstr("shot.json: /thrown/mu is missing"));
  EXPECT_THAT(Complaint(With("\"travels\"", "\"travel\"")),
              HasSubstr("shot.json: /camera/travel is not a name"));
  EXPECT_THAT(Complaint(With("\"left\"", "\"up\"")),
              HasSubstr("/camera/travels is 'up', must be right or left"));
  EXPECT_THAT(Complaint(With("\"fps\": 1000", "\"fps\": -5")),
              HasSubstr("/camera/fps is -5, must be positive"));
  EXPECT_THAT(Complaint(With("\"bit_depth\": 12", "\"bit_depth\": 8.5")),
              HasSubstr("/camera/bit_depth is 8.5, must be a whole number"));
  EXPECT_THAT(Complaint(With("\"frames\": 120", "\"frames\": 1e30")),
              HasSubstr("/frames is 1e+30, must be a whole number"));
  EXPECT_THAT(
      Complaint(With("\"frames\": 120", "\"frames\": 18446744073709551615")),
      HasSubstr("/frames is 18446744073709551615, must be a whole number"));
  EXPECT_THAT(Complaint(With("\"long_mm\": 40", "\"long_mm\": \"40\"")),
              HasSubstr("/body/long_mm is \"40\", must be a number"));
  EXPECT_THAT(Complaint(With("rectangle", "cube")),
              HasSubstr("/body/kind is 'cube', must be sphere or rectangle"));
  EXPECT_THAT(Complaint(With("\"frame\": 70.25", "\"frame\": 30")),
              HasSubstr("/thrown/touchdown/frame is 30"));
  EXPECT_THAT(Complaint(With("_deg\": 25", "_deg\": 91")),
              HasSubstr("/thrown/touchdown/approach_angle_deg is 91"));
  EXPECT_THAT(Complaint(With("\"touchdown\"", "\"landing\"")),
              HasSubstr("/thrown must have either start or touchdown"));
  // 30 ms of flight that end at 1 degree would have begun in the ground.
  EXPECT_THAT(Complaint(With("_deg\": 25", "_deg\": 1")),
              HasSubstr("would be in the ground"));
  // What only the renderer or the physics can tell.
  EXPECT_THAT(Complaint(With("0.5,", "1.5,")),
              HasSubstr("shot.json: restitution is 1.5"));
  EXPECT_THAT(Complaint(With("\"left\"", "\"left\", \"psf_sigma_px\": 99")),
              HasSubstr("shot.json: scene: camera.psf_sigma_px is 99"));
  EXPECT_THROW(ReadSceneFile("/nonexistent/scene.json"), core::InputError);
}

}  // namespace
}  // namespace touchdown::pipeline
