#include "app/shots/rig_prediction.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/support/temporary_folder.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

using core::kDegree;
using core::kMillimetre;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

rig::Description Ejector() {
  rig::Description rig = rig::ParseDescription(rig::ExampleDescription(), "it");
  rig.body = core::Sphere({40 * kMillimetre, 0.0});
  rig.muzzle_height_min_m = 0.03;
  return rig;
}

core::Trial Thrown(double angle_deg, double launch_mps) {
  core::Trial trial;
  trial.id = "t";
  trial.body = core::Sphere({40 * kMillimetre, 0.0});
  trial.set_angle_rad = angle_deg * kDegree;
  trial.set_speed_mps = launch_mps;
  return trial;
}

// A level shot that arrives at angle a has fallen by h with 2 g h = v0^2 tan^2
// a; at touchdown it has v0 / cos a.
TEST(PredictShot, ALevelShotInClosedForm) {
  const rig::Description rig = Ejector();
  for (const double angle_deg : {15.0, 20.0, 35.0}) {
    core::Trial trial = Thrown(angle_deg, 3.0);
    const double v = 3.0 / std::cos(*trial.set_angle_rad);
    trial.first.motion.before_speed_mps = core::Estimate{v, 0.01};
    const auto p = PredictShot(rig, trial);
    ASSERT_TRUE(p.launch_speed_mps) << p.launch_speed_mps.error().reason;
    EXPECT_NEAR(p.launch_speed_mps->value, 3.0, 1e-6);
    EXPECT_GT(p.launch_speed_mps->u, 0.0);
    EXPECT_NEAR(p.approach_angle_rad->value, *trial.set_angle_rad, 1e-6);
    EXPECT_NEAR(p.measured_launch_speed_mps->value, 3.0, 1e-6);
    // v u(v) / v0, and what the height and gravity add.
    const double g = rig.gravity_mps2.value;
    const double fall = (v * v - 9.0) / (2 * g);
    EXPECT_NEAR(p.measured_launch_speed_mps->u,
                std::hypot(v * 0.01, g * rig.u_muzzle_height_m,
                           fall * rig.gravity_mps2.u) /
                    3.0,
                1e-8);
  }
}

// Near the vertical the fall gives nearly all of the speed.
TEST(PredictShot, ASteepLevelShotIsFound) {
  const rig::Description rig = Ejector();
  for (const double angle_deg : {80.0, 85.0, 88.0}) {
    // From 0.3 m: v0 = sqrt(2 g h) / tan a.
    const double launch_mps = std::sqrt(2 * rig.gravity_mps2.value * 0.3) /
                              std::tan(angle_deg * kDegree);
    const auto p = PredictShot(rig, Thrown(angle_deg, launch_mps));
    ASSERT_TRUE(p.launch_speed_mps) << p.launch_speed_mps.error().reason;
    EXPECT_NEAR(p.launch_speed_mps->value, launch_mps, 1e-8);
    EXPECT_NEAR(p.approach_angle_rad->value, angle_deg * kDegree, 1e-6);
  }
}

TEST(PredictShot, SaysWhyNot) {
  const rig::Description rig = Ejector();
  const auto why = [&](const core::Trial& trial) {
    const auto p = PredictShot(rig, trial);
    return p.launch_speed_mps ? "" : p.launch_speed_mps.error().reason;
  };
  core::Trial trial = Thrown(20, 3);
  EXPECT_EQ(why(trial), "");
  EXPECT_THAT(PredictShot(rig, trial).measured_launch_speed_mps.error().reason,
              HasSubstr("no contact"));
  trial.set_speed_mps.reset();
  EXPECT_THAT(why(trial), HasSubstr("launch speed"));
  EXPECT_THAT(why(Thrown(20, 1000)), ::testing::Not(::testing::IsEmpty()));
  EXPECT_THAT(why(Thrown(120, 3)), HasSubstr("no angle of this kind"));
  trial = Thrown(20, 3);
  trial.body.kind = core::BodyKind::kRectangle;
  EXPECT_THAT(why(trial), HasSubstr("throws a sphere"));
}

TEST(PredictTrials, NamesTheRigAndItsFile) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "rig.toml";
  std::ofstream(path) << rig::ExampleDescription();
  const core::Trial trial = Thrown(20, 3);
  const auto used = PredictTrials(path, {&trial, 1});
  ASSERT_GE(used.facts.size(), 2u);
  EXPECT_EQ(used.facts[0].second, "bench ejector");
  EXPECT_THAT(used.facts[1].second, HasSubstr("rig.toml, SHA-256 "));
  EXPECT_TRUE(used.predictions.contains("t"));
  EXPECT_THROW(PredictTrials(folder.path() / "none.toml", {}),
               core::InputError);
}

}  // namespace
}  // namespace touchdown::pipeline
