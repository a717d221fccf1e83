#include "app/measure/left_out.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "app/measure/judge.h"
#include "tests/pipeline/filmed.h"
#include "tests/vision/bounce_in_air.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::pipeline {
namespace {

using core::kDegree;

// A contact at 20 deg and 4 m/s, seen 60 px right of the middle of 240 by 120.
Analysis AtTwenty() {
  Analysis a;
  a.clip.format = "mp4";
  a.clip.width_px = 240;
  a.clip.height_px = 120;
  a.clip.frames = 100;
  a.clip.time_base.fps = 1000.0;
  a.scale = calib::Scale{{1000.0, 1.0, {}}, calib::ScaleSource::kUser};
  auto& first = a.contacts.first;
  first.contact.found = true;
  first.contact.frame = core::Estimate{50.0, 0.01, {}};
  first.contact.approach_angle_rad =
      core::Estimate{20.0 * kDegree, 0.05 * kDegree, {}};
  first.motion.before_speed_mps = core::Estimate{4.0, 0.01, {}};
  first.motion.before_normal_mps =
      core::Estimate{-4.0 * std::sin(20.0 * kDegree), 0.01, {}};
  a.track.emplace();
  for (const std::int64_t frame : {10, 50}) {
    vision::Pose pose;
    pose.frame = frame;
    pose.centre = {180.0, 60.0};
    a.track->poses.push_back(pose);
  }
  return a;
}

const LeftOutEffect& Named(const std::vector<LeftOutEffect>& effects,
                           const std::string& name) {
  const auto at =
      std::find_if(effects.begin(), effects.end(),
                   [&](const LeftOutEffect& e) { return e.name == name; });
  EXPECT_NE(at, effects.end()) << name;
  return *at;
}

TEST(LeftOut, ByHand) {
  const auto effects = LeftOutEffects(AtTwenty());
  const double sc = std::sin(20.0 * kDegree) * std::cos(20.0 * kDegree);
  // r / f = 60 / 240.
  EXPECT_NEAR(Named(effects, "path out of the plane").error_rad,
              0.25 * std::sin(2.0 * kDegree) +
                  (1.0 / std::cos(2.0 * kDegree) - 1.0) * sc,
              1e-12);
  // 1.368 px a frame of 120 rows.
  EXPECT_NEAR(Named(effects, "rolling shutter").error_rad,
              4.0 * std::sin(20.0 * kDegree) / 120.0 * sc, 1e-12);
  // 40 ms of flight.
  EXPECT_NEAR(Named(effects, "gravity along the ground").error_rad,
              core::kStandardGravity_mps2 * std::sin(1.0 * kDegree) * 0.04 /
                  8.0 * std::sin(20.0 * kDegree),
              1e-12);
}

// k = 0.75 0.47 1.2 / (1000 0.04) = 0.0106/m over 0.16 m: half of it is 0.085 %
// of 4 m/s, of which u is 0.25 %.
TEST(LeftOut, DragOfALightBodyByHand) {
  Analysis a = AtTwenty();
  a.track->body.radius_px.value = 20.0;
  DescribeDrag(a);
  EXPECT_EQ(a.scene_model.left_out["drag"],
            "too few frames of flight to tell it; of a body as dense as water "
            "it would be 0.085 % of the speed at touchdown, 0.34 u");
  // A hand held it until frame 30: half of the path.
  a.contacts.evidence.emplace_back().before.emplace().first_frame = 30;
  DescribeDrag(a);
  EXPECT_TRUE(a.scene_model.left_out["drag"].find("0.042 %") !=
              std::string::npos)
      << a.scene_model.left_out["drag"];
  a.contacts.drag_per_px = core::Estimate{3e-5, 1e-5};
  DescribeDrag(a);
  EXPECT_TRUE(a.scene_model.left_out["drag"].starts_with(
      "the flights show 0.030 +- 0.010 of the speed lost on a metre; "));
  EXPECT_TRUE(a.warnings.empty());
  EXPECT_NEAR(ProbabilityOfDrag(a.contacts), 1.0 / (1.0 + 1e3 * std::exp(-4.5)),
              1e-12);
  a.contacts.drag_per_px = core::Estimate{5e-5, 1e-5};
  DescribeDrag(a);
  DescribeDrag(a);
  EXPECT_EQ(a.warnings.size(), 1u);
}

// What the flights show beyond doubt is in u, and the truth within it; what
// they do not show changes nothing.
TEST(LeftOut, DragThatTheFlightsShowIsInU) {
  for (const double k : {0.0, vision::synthetic::kLight}) {
    std::mt19937_64 engine(5);
    vision::synthetic::Bounce bounce;
    bounce.k = k;
    Analysis a;
    a.plane = bounce.Film(engine);
    a.contacts = vision::FindContacts(*a.plane);
    ASSERT_TRUE(a.contacts.first.motion.restitution);
    const core::Estimate alone = *a.contacts.first.motion.restitution;
    const core::Estimate pooled = *a.contacts.restitution.value;
    AddDrag(a, {});
    const core::Estimate& with = *a.contacts.first.motion.restitution;
    EXPECT_EQ(with.value, alone.value);
    const auto& budget = a.contacts.first.contact.approach_budget;
    const bool named =
        std::any_of(budget.begin(), budget.end(),
                    [](const auto& line) { return line.source == "drag"; });
    EXPECT_EQ(named, k > 0.0);
    if (k == 0.0) {
      EXPECT_EQ(with.u, alone.u);
      continue;
    }
    EXPECT_GT(std::abs(alone.value - bounce.restitution), 4.0 * alone.u);
    EXPECT_LT(std::abs(with.value - bounce.restitution), 1.5 * with.u);
    EXPECT_GT(a.contacts.restitution.value->u, pooled.u);
  }
}

TEST(LeftOut, RawCamerasDoNotRoll) {
  Analysis a = AtTwenty();
  a.clip.format = "mraw";
  for (const auto& effect : LeftOutEffects(a)) {
    EXPECT_NE(effect.name, "rolling shutter");
  }
}

TEST(LeftOut, WarnsWhereARollingShutterWouldDecide) {
  Analysis a = AtTwenty();
  DescribeLeftOut(a);
  EXPECT_TRUE(a.warnings.empty());
  a.clip.time_base.fps = 250.0;  // 5.5 px a frame: 0.84 deg
  for (int i = 0; i < 2; ++i) DescribeLeftOut(a);
  ASSERT_EQ(a.warnings.size(), 1U);
  EXPECT_EQ(a.warnings[0].rfind("rolling shutter", 0), 0U);
}

TEST(LeftOut, NothingWithoutAnAngle) {
  Analysis a = AtTwenty();
  a.contacts.first.contact.approach_angle_rad = core::AbsentBecause("hidden");
  EXPECT_TRUE(LeftOutEffects(a).empty());
}

TEST(LeftOut, StandsInTheDocumentAndTheText) {
  const auto film = filmed::Default(core::BodyKind::kSphere);
  AnalyzeOptions options;
  options.scale_px_per_m = core::Estimate{1000.0, 1.0, {}};
  const Analysis a =
      AnalyzeClip(vision::OpenScene(filmed::BuildScene(film), 1), options);
  for (const char* name : {"path out of the plane", "rolling shutter",
                           "gravity along the ground", "light and gamma"}) {
    EXPECT_EQ(a.scene_model.left_out.count(name), 1U) << name;
  }
}

}  // namespace
}  // namespace touchdown::pipeline
