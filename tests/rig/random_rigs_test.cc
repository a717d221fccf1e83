// Plans of random rigs, played by the exact rigid motion of `analysis`, which
// shares no code with the rig's own flight. 60 rigs; TOUCHDOWN_LONG_TESTS=1
// makes 2000.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <random>
#include <string>

#include "touchdown/analysis/theory/rigid_motion.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/launch.h"
#include "touchdown/rig/setpoints.h"

namespace touchdown::rig {
namespace {

using core::AngleKind;
using core::kDegree;
using core::literals::operator""_mm;

int Rigs() {
  return std::getenv("TOUCHDOWN_LONG_TESTS") != nullptr ? 2000 : 60;
}

double Between(std::mt19937_64& engine, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(engine);
}

Description RandomRig(std::mt19937_64& engine) {
  Description rig = ParseDescription(ExampleDescription(), "example");
  const double length = Between(engine, 20.0_mm, 120.0_mm);
  rig.body = core::Rectangle({length, 0.02_mm, {}},
                             {length * Between(engine, 0.1, 1.0), 0.02_mm, {}});
  rig.mass_kg.value = Between(engine, 0.03, 0.3);
  rig.seat_angle_rad.value = Between(engine, -30.0, 30.0) * kDegree;
  rig.spin_rad_per_s.value =
      engine() % 4 == 0 ? 0.0 : Between(engine, -4000.0, 4000.0) * kDegree;
  rig.elevation_min_rad = Between(engine, -88.0, 0.0) * kDegree;
  rig.elevation_max_rad = Between(engine, 0.0, 88.0) * kDegree;
  rig.muzzle_height_min_m = Between(engine, 0.0, 0.3);
  rig.muzzle_height_max_m = rig.muzzle_height_min_m + Between(engine, 0.0, 0.8);
  rig.compression_max_m = Between(engine, 20.0_mm, 60.0_mm);
  return rig;
}

// What follows from a setting: nothing where the body starts in the ground,
// stays in the barrel, or strikes while its centre rises.
std::optional<analysis::TouchdownTruth> Play(const Description& rig,
                                             const Setting& setting) {
  const auto muzzle = LaunchSpeed(MakeLaunch(rig, setting.elevation_rad),
                                  setting.compression_m);
  if (!muzzle || !Allowed(CheckCompression(rig, setting.compression_m))) {
    return std::nullopt;
  }
  const double face = setting.elevation_rad + rig.seat_angle_rad.value;
  if (setting.muzzle_height_m < CentreHeightAtTouchdown(rig, face)) {
    return std::nullopt;
  }
  analysis::RigidMotionProblem p;
  p.body = *rig.body;
  p.gravity_mps2 = rig.gravity_mps2.value;
  p.start = {0.0,
             {0.0, setting.muzzle_height_m},
             face,
             muzzle->speed_mps * std::cos(setting.elevation_rad),
             muzzle->speed_mps * std::sin(setting.elevation_rad),
             rig.spin_rad_per_s.value};
  p.end_s = 5.0;
  const auto touch = FirstTouchdown(SimulateRigidMotion(p));
  if (!touch || touch->from_start || touch->before.vy_mps >= 0.0) {
    return std::nullopt;
  }
  return touch;
}

double AngleOf(const analysis::TouchdownTruth& truth, AngleKind kind) {
  if (kind == AngleKind::kApproach) return truth.approach_angle_rad;
  return kind == AngleKind::kRadius ? *truth.radius_angle_rad
                                    : *truth.face_angle_rad;
}

double SpeedOf(const analysis::TouchdownTruth& truth) {
  return std::hypot(truth.before.vx_mps, truth.before.vy_mps);
}

const Predicted& PredictedAngle(const ContactPrediction& c, AngleKind kind) {
  if (kind == AngleKind::kApproach) return c.approach_angle_rad;
  return kind == AngleKind::kRadius ? c.radius_angle_rad : c.face_angle_rad;
}

constexpr AngleKind kKinds[] = {AngleKind::kApproach, AngleKind::kRadius,
                                AngleKind::kFace};

// Arrives as wished: within 1e-6 rad and, since all inputs are at their
// values, far within the u that the plan states.
void ExpectArrival(const Description& rig, const ContactWish& wish,
                   const SetPoint& point, int i) {
  const auto played = Play(rig, point.setting);
  ASSERT_TRUE(played) << i << " " << core::Name(wish.kind);
  const double miss = std::remainder(
      AngleOf(*played, wish.kind) - wish.angle_rad, std::numbers::pi);
  EXPECT_NEAR(miss, 0.0, 1e-6) << i << " " << core::Name(wish.kind);
  EXPECT_NEAR(SpeedOf(*played), wish.speed_mps, 1e-6 * wish.speed_mps) << i;
  if (wish.corner) {
    EXPECT_EQ(played->corner, wish.corner) << i;
  }
  const auto& predicted = PredictedAngle(point.contact, wish.kind).first_order;
  if (predicted) {
    EXPECT_LE(std::abs(miss), predicted->u + 1e-9) << i;
  }
  EXPECT_LE(point.setting.elevation_rad, rig.elevation_max_rad + 1e-9);
  EXPECT_GE(point.setting.elevation_rad, rig.elevation_min_rad - 1e-9);
  EXPECT_LE(point.setting.muzzle_height_m, rig.muzzle_height_max_m + 1e-9);
  EXPECT_GE(point.setting.muzzle_height_m, rig.muzzle_height_min_m - 1e-9);
}

TEST(RandomRigs, NothingReachableIsRefused) {
  std::mt19937_64 engine(2401);
  std::mt19937_64 draws(1);
  int reached = 0;
  for (int i = 0; i < Rigs(); ++i) {
    const Description rig = RandomRig(engine);
    std::optional<analysis::TouchdownTruth> truth;
    Setting setting;
    for (int attempt = 0; attempt < 50 && !truth; ++attempt) {
      setting.elevation_rad =
          Between(engine, rig.elevation_min_rad, rig.elevation_max_rad);
      setting.muzzle_height_m =
          Between(engine, rig.muzzle_height_min_m, rig.muzzle_height_max_m);
      setting.compression_m = Between(engine, 1.0_mm, *rig.compression_max_m);
      truth = Play(rig, setting);
    }
    if (!truth) continue;
    ++reached;
    for (const AngleKind kind : kKinds) {
      for (const bool held : {false, true}) {
        ContactWish wish;
        wish.kind = kind;
        wish.angle_rad = AngleOf(*truth, kind);
        wish.speed_mps = SpeedOf(*truth);
        if (kind != AngleKind::kApproach) wish.corner = truth->corner;
        if (held) wish.muzzle_height_m = setting.muzzle_height_m;
        const auto point = PlanContact(rig, wish, {2}, draws);
        ASSERT_TRUE(point) << i << " " << core::Name(kind)
                           << (held ? " held" : "") << ": "
                           << point.error().reason;
        ExpectArrival(rig, wish, *point, i);
      }
    }
  }
  EXPECT_GT(reached, Rigs() * 9 / 10);
}

// A refusal names a limit; without that limit it is another refusal or none.
TEST(RandomRigs, PlansArriveOrAreRefusedForTheTrueReason) {
  std::mt19937_64 engine(2402);
  std::mt19937_64 draws(1);
  int planned = 0;
  std::map<std::string, int> refused;
  for (int i = 0; i < Rigs(); ++i) {
    const Description rig = RandomRig(engine);
    for (const AngleKind kind : kKinds) {
      ContactWish wish;
      wish.kind = kind;
      wish.angle_rad =
          Between(engine, kind == AngleKind::kFace ? -90.0 : 0.0, 90.0) *
          kDegree;
      wish.speed_mps = Between(engine, 0.5, 8.0);
      if (engine() % 3 == 0) {
        wish.corner =
            engine() % 2 ? core::Corner::kLeading : core::Corner::kTrailing;
      }
      const auto point = PlanContact(rig, wish, {2}, draws);
      if (point) {
        ++planned;
        ExpectArrival(rig, wish, *point, i);
        continue;
      }
      const std::string& reason = point.error().reason;
      // Of several attitudes each has its reason; one limit at a time can be
      // lifted only where there is one.
      if (reason.find("; or ") != std::string::npos) continue;
      Description freed = rig;
      ContactWish freely = wish;
      std::string limit;
      if (reason.find("needs an elevation") != std::string::npos) {
        limit = "needs an elevation";
        freed.elevation_min_rad = -90.0 * kDegree;
        freed.elevation_max_rad = 90.0 * kDegree;
      } else if (reason.find("within the rig's range") == 0) {
        continue;  // no single limit
      } else if (reason.find("muzzle") != std::string::npos &&
                 reason.find("a launch at") == std::string::npos) {
        limit = "muzzle";
        freed.muzzle_height_min_m = 0.0;
        freed.muzzle_height_max_m = 20.0;
      } else if (reason.find("a launch at") != std::string::npos) {
        limit = "travel";
        freed.compression_max_m.reset();
        freed.springs.free_length_m.reset();
        freed.springs.allowable_shear_pa.reset();
      } else if (reason.find("corner") != std::string::npos) {
        limit = "lands first";
        freely.corner.reset();
      } else {
        continue;
      }
      ++refused[limit];
      const auto again = FindSetting(freed, freely);
      if (again) continue;
      EXPECT_EQ(again.error().reason.find(limit), std::string::npos)
          << i << ": " << reason << " -> " << again.error().reason;
    }
  }
  EXPECT_GT(planned, Rigs() / 4);
  EXPECT_GE(refused.size(), 3U);
}

}  // namespace
}  // namespace touchdown::rig
