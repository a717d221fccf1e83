#include "app/pipeline/analyze.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "touchdown/core/units.h"
#include "touchdown/vision/render.h"

namespace touchdown::pipeline {
namespace {

using core::kDegree;

// A sphere of 40 mm that meets level ground at `angle_rad` and 1.5 m/s between
// two frames, and leaves with restitution 0.5.
vision::Scene Bounce(double angle_rad, double contact_s, bool left) {
  vision::Scene scene;
  scene.body = core::Sphere({0.040, 0.0});
  const double v = 1.5;
  const double g = core::kStandardGravity_mps2;
  scene.pose = [=](double time_s) {
    const double t = time_s - contact_s;
    const double v_t = v * std::cos(angle_rad) * (t < 0.0 ? 1.0 : 0.8);
    const double v_n = v * std::sin(angle_rad) * (t < 0.0 ? -1.0 : 0.5);
    vision::ScenePose pose;
    pose.centre = {-0.03 + v_t * t, 0.020 + v_n * t - 0.5 * g * t * t};
    return pose;
  };
  scene.frames = 90;
  scene.camera.roll_rad = 0.012;
  scene.camera.travels_left = left;
  scene.noise.read_dn = 2.5;
  scene.look.texture_amplitude = 0.03;
  return scene;
}

AnalyzeOptions KnownSphere() {
  AnalyzeOptions options;
  options.diameter_m = core::Estimate{0.040, 1e-5};
  return options;
}

TEST(AnalyzeClip, RenderedSpheresAgreeWithTheirTruth) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  double chi2 = 0.0;
  constexpr int kClips = 8;
  for (int i = 0; i < kClips; ++i) {
    const double angle = (30.0 + 10.0 * uniform(engine)) * kDegree;
    const double contact_s = 0.0225 + 0.001 * uniform(engine);
    const Analysis a = AnalyzeClip(
        vision::OpenScene(Bounce(angle, contact_s, i % 2 == 1), engine()),
        KnownSphere());
    const core::ContactRecord& first = a.contacts.first;
    ASSERT_TRUE(first.contact.found) << first.contact.reason;
    const core::Estimate& measured = *first.contact.approach_angle_rad;
    const double z = (measured.value - angle) / measured.u;
    EXPECT_LT(std::abs(z), 4.0) << i;
    EXPECT_LT(measured.u, 0.03 * kDegree);
    chi2 += z * z;
    EXPECT_NEAR(first.contact.time_s->value, contact_s,
                4.0 * first.contact.time_s->u);
    ASSERT_TRUE(first.motion.restitution);
    EXPECT_NEAR(first.motion.restitution->value, 0.5,
                4.0 * first.motion.restitution->u);
    EXPECT_EQ(first.state.label, core::MotionState::kBounce);
  }
  // 99.9 % band of chi squared with 8 degrees of freedom.
  EXPECT_LT(chi2, 26.1);
}

TEST(AnalyzeClip, SaysThatNothingMoves) {
  vision::Scene scene = Bounce(0.5, 10.0, false);
  scene.pose = [](double) { return vision::ScenePose{{5.0, 5.0}, 0.0}; };
  scene.frames = 20;
  const Analysis a = AnalyzeClip(vision::OpenScene(scene, 3), KnownSphere());
  EXPECT_FALSE(a.body);
  EXPECT_FALSE(a.contacts.first.contact.found);
  EXPECT_EQ(a.contacts.first.state.label, core::MotionState::kUndecided);
  EXPECT_THAT(a.no_body_reason, ::testing::HasSubstr("nothing moves"));
}

TEST(AnalyzeClip, RefusesImpossibleOptionsByName) {
  const auto refuse = [](const AnalyzeOptions& options, const char* field) {
    try {
      AnalyzeClip(vision::OpenScene(Bounce(0.5, 0.02, false), 1), options);
      ADD_FAILURE() << "accepted a wrong " << field;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr(field));
    }
  };
  AnalyzeOptions options;
  options.diameter_m = core::Estimate{-1.0, 0.0};
  refuse(options, "diameter");
  options = {};
  options.last_frame = 1000;
  refuse(options, "frames");
  options = {};
  options.region = {0, 0, 10000, 5};
  refuse(options, "region");
  options = {};
  options.body_kind = core::BodyKind::kRectangle;
  options.diameter_m = core::Estimate{0.04, 0.0};
  refuse(options, "body");
}

// Every name of the contract is there, whatever was found, and every null has
// its reason.
void ExpectWholeDocument(const std::string& text) {
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["schema"], "touchdown.analysis/1");
  for (const char* name : {"clip", "scale", "ground", "body", "contact",
                           "state", "later_contacts", "motion", "scene_model",
                           "warnings", "timing_s", "absent", "software"}) {
    EXPECT_TRUE(json.contains(name)) << name;
  }
  for (const char* name :
       {"path", "id", "sha256", "format", "width_px", "height_px", "bit_depth",
        "frames", "first_camera_frame", "time_base"}) {
    EXPECT_TRUE(json["clip"].contains(name)) << name;
  }
  for (const char* name :
       {"found", "time_s", "frame", "angle_kind", "angle_deg",
        "approach_angle_deg", "radius_angle_deg", "face_angle_deg", "corner",
        "duration_s", "budget"}) {
    ASSERT_TRUE(json["contact"].contains(name)) << name;
    if (json["contact"][name].is_null()) {
      EXPECT_TRUE(json["absent"].contains(std::string("contact.") + name))
          << name;
    }
  }
  for (const char* name :
       {"label", "p_bounce", "reason", "max_gap_mm", "bounce_height_mm",
        "detectable_gap_mm", "micro_bounce"}) {
    ASSERT_TRUE(json["state"].contains(name)) << name;
    if (json["state"][name].is_null()) {
      EXPECT_TRUE(json["absent"].contains(std::string("state.") + name))
          << name;
    }
  }
  for (const char* name :
       {"before", "after", "restitution", "centre_rebound_ratio",
        "impulse_ratio", "gravity_check_mps2"}) {
    EXPECT_TRUE(json["motion"].contains(name)) << name;
  }
  for (const char* name : {"total", "decode", "track", "digest"}) {
    EXPECT_TRUE(json["timing_s"].contains(name)) << name;
  }
}

TEST(ToJson, IsWholeWhetherFoundOrNot) {
  ExpectWholeDocument(ToJson(AnalyzeClip(
      vision::OpenScene(Bounce(0.5, 0.02, false), 1), KnownSphere())));
  // No scale: lengths are absent, angles are not.
  const Analysis unscaled =
      AnalyzeClip(vision::OpenScene(Bounce(0.5, 0.02, false), 1));
  const std::string text = ToJson(unscaled);
  ExpectWholeDocument(text);
  const auto json = nlohmann::json::parse(text);
  EXPECT_TRUE(json["scale"].is_null());
  EXPECT_TRUE(json["state"]["max_gap_mm"].is_null());
  EXPECT_TRUE(json["contact"]["angle_deg"].is_object());
  // Nothing there at all.
  vision::Scene empty = Bounce(0.5, 0.02, false);
  empty.pose = [](double) { return vision::ScenePose{{5.0, 5.0}, 0.0}; };
  empty.frames = 20;
  ExpectWholeDocument(ToJson(AnalyzeClip(vision::OpenScene(empty, 3))));
}

}  // namespace
}  // namespace touchdown::pipeline
