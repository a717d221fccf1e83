#include "touchdown/rig/setpoints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "touchdown/core/units.h"

namespace touchdown::rig {
namespace {

using core::AngleKind;
using core::Corner;
using core::literals::operator""_deg;
using core::literals::operator""_mm;
using testing::HasSubstr;

constexpr PredictOptions kFew{2};

Description Blocks() {
  return ParseDescription(ExampleDescription(), "example");
}

Description Spheres() {
  Description rig = Blocks();
  rig.body = core::Sphere({40.0_mm, 0.02_mm, {}});
  rig.elevation_min_rad = -90.0_deg;
  rig.elevation_max_rad = 90.0_deg;
  rig.muzzle_height_min_m = 30.0_mm;
  return rig;
}

ContactWish Wish(AngleKind kind, double angle_rad, double speed_mps) {
  ContactWish wish;
  wish.kind = kind;
  wish.angle_rad = angle_rad;
  wish.speed_mps = speed_mps;
  return wish;
}

std::string ReasonOf(const Description& rig, const ContactWish& wish) {
  const auto setting = FindSetting(rig, wish);
  return setting ? "possible" : setting.error().reason;
}

TEST(SetPoints, SphereArrivesAsWished) {
  const Description rig = Spheres();
  std::mt19937_64 engine(1);
  int possible = 0;
  for (double deg = 0.0; deg <= 90.0; deg += 2.5) {
    for (const double speed : {1.0, 2.0, 4.0, 8.0}) {
      const auto wish = Wish(AngleKind::kApproach, deg * core::kDegree, speed);
      const auto point = PlanContact(rig, wish, kFew, engine);
      if (!point) continue;
      ++possible;
      EXPECT_NEAR(point->contact.approach_angle_rad.first_order->value,
                  deg * core::kDegree, 1e-8)
          << deg << " " << speed;
      EXPECT_NEAR(point->contact.impact_speed_mps.first_order->value, speed,
                  1e-9);
      EXPECT_TRUE(Allowed(point->contact.findings));
    }
  }
  EXPECT_GT(possible, 100);
}

TEST(SetPoints, ApproachPrefersTheLevelShot) {
  // 4 m/s at 20 deg: a fall of (4 sin 20)^2/(2 g) and half a diameter.
  const Description rig = Spheres();
  const auto setting =
      FindSetting(rig, Wish(AngleKind::kApproach, 20.0_deg, 4.0));
  ASSERT_TRUE(setting);
  const double down = 4.0 * std::sin(20.0_deg);
  EXPECT_EQ(setting->elevation_rad, 0.0);
  EXPECT_NEAR(setting->muzzle_height_m,
              down * down / (2.0 * rig.gravity_mps2.value) + 20.0_mm, 1e-12);
}

TEST(SetPoints, ApproachBelowItsHeightIsAimedDownward) {
  const auto setting =
      FindSetting(Spheres(), Wish(AngleKind::kApproach, 80.0_deg, 5.0));
  ASSERT_TRUE(setting);  // the level shot would need 1.26 m; the rig has 0.8
  EXPECT_NEAR(setting->muzzle_height_m, 800.0_mm, 1e-12);
  EXPECT_LT(setting->elevation_rad, 0.0);
  // A rig that cannot aim downward throws it up.
  Description up = Spheres();
  up.elevation_min_rad = 0.0;
  const auto lob = FindSetting(up, Wish(AngleKind::kApproach, 80.0_deg, 5.0));
  ASSERT_TRUE(lob);
  EXPECT_NEAR(lob->elevation_rad, -setting->elevation_rad, 1e-12);
}

TEST(SetPoints, HeightCanBeHeld) {
  ContactWish wish = Wish(AngleKind::kApproach, 45.0_deg, 4.0);
  wish.muzzle_height_m = 120.0_mm;
  std::mt19937_64 engine(1);
  const auto point = PlanContact(Spheres(), wish, kFew, engine);
  ASSERT_TRUE(point);
  EXPECT_EQ(point->setting.muzzle_height_m, 120.0_mm);
  EXPECT_NEAR(point->contact.approach_angle_rad.first_order->value, 45.0_deg,
              1e-9);
}

TEST(SetPoints, AttitudesArriveAsWished) {
  Description rig = Blocks();
  rig.seat_angle_rad.value = 1.5_deg;
  std::mt19937_64 engine(1);
  const double least = std::atan(20.0 / 60.0);
  int possible = 0;
  for (const double spin_deg : {0.0, -20.0, 35.0}) {
    rig.spin_rad_per_s.value = spin_deg * core::kDegree;
    for (double deg = 19.0; deg < 75.0; deg += 4.0) {
      for (const Corner corner : {Corner::kTrailing, Corner::kLeading}) {
        ContactWish wish = Wish(AngleKind::kRadius, deg * core::kDegree, 4.0);
        wish.corner = corner;
        const auto point = PlanContact(rig, wish, kFew, engine);
        if (!point) continue;
        ++possible;
        EXPECT_NEAR(point->contact.radius_angle_rad.first_order->value,
                    deg * core::kDegree, 1e-9);
        EXPECT_NEAR(std::abs(point->contact.face_angle_rad.first_order->value),
                    deg * core::kDegree - least, 1e-9);
        EXPECT_EQ(point->contact.corner, corner) << deg;
        EXPECT_NEAR(point->contact.impact_speed_mps.first_order->value, 4.0,
                    1e-9);
      }
    }
    for (double deg = -40.0; deg <= 40.0; deg += 5.0) {
      const auto point = PlanContact(
          rig, Wish(AngleKind::kFace, deg * core::kDegree, 4.0), kFew, engine);
      ASSERT_TRUE(point) << deg << point.error().reason;
      EXPECT_NEAR(point->contact.face_angle_rad.first_order->value,
                  deg * core::kDegree, 1e-9);
    }
  }
  EXPECT_GT(possible, 60);
}

TEST(SetPoints, RectanglesApproachCountsItsAttitude) {
  Description rig = Blocks();
  rig.elevation_min_rad = -80.0_deg;
  std::mt19937_64 engine(1);
  for (const double deg : {26.0, 40.0, 55.0, 70.0}) {
    for (const double speed : {4.0, 6.0}) {
      const auto point = PlanContact(
          rig, Wish(AngleKind::kApproach, deg * core::kDegree, speed), kFew,
          engine);
      ASSERT_TRUE(point) << point.error().reason;
      EXPECT_NEAR(point->contact.approach_angle_rad.first_order->value,
                  deg * core::kDegree, 1e-8);
      EXPECT_NEAR(point->contact.impact_speed_mps.first_order->value, speed,
                  1e-8);
    }
  }
}

TEST(SetPoints, RadiusPrefersTheTrailingCorner) {
  Description rig = Blocks();
  const auto up = FindSetting(rig, Wish(AngleKind::kRadius, 30.0_deg, 4.0));
  ASSERT_TRUE(up);
  EXPECT_GT(up->elevation_rad, 0.0);
  rig.elevation_max_rad = 5.0_deg;
  const auto down = FindSetting(rig, Wish(AngleKind::kRadius, 30.0_deg, 4.0));
  ASSERT_TRUE(down);
  EXPECT_LT(down->elevation_rad, 0.0);
}

TEST(SetPoints, RefusesWithTheReason) {
  const Description spheres = Spheres();
  Description blocks = Blocks();
  EXPECT_THAT(ReasonOf(spheres, Wish(AngleKind::kRadius, 30.0_deg, 4.0)),
              HasSubstr("a sphere has no radius angle"));
  EXPECT_THAT(ReasonOf(spheres, Wish(AngleKind::kFace, 30.0_deg, 4.0)),
              HasSubstr("a sphere has no face angle"));
  ContactWish wish = Wish(AngleKind::kApproach, 30.0_deg, 4.0);
  wish.corner = Corner::kLeading;
  EXPECT_THAT(ReasonOf(spheres, wish), HasSubstr("no corners"));
  // E6: no body of finite thickness stands flatter than its diagonal.
  EXPECT_THAT(ReasonOf(blocks, Wish(AngleKind::kRadius, 7.8_deg, 4.0)),
              HasSubstr("at least atan(short/long) = 18.43 deg"));
  // The fall alone is steeper.
  EXPECT_THAT(ReasonOf(blocks, Wish(AngleKind::kApproach, 5.0_deg, 4.0)),
              HasSubstr("lower the muzzle to"));
  EXPECT_THAT(ReasonOf(blocks, Wish(AngleKind::kApproach, 5.0_deg, 1.0)),
              HasSubstr("the wanted speed is 1"));
  EXPECT_THAT(ReasonOf(blocks, Wish(AngleKind::kRadius, 25.0_deg, 1.0)),
              HasSubstr("the wanted speed is 1"));
  // Elevation, compression, height.
  EXPECT_THAT(ReasonOf(blocks, Wish(AngleKind::kRadius, 85.0_deg, 4.0)),
              HasSubstr("needs an elevation of 66.57 deg, the rig's is -60"));
  EXPECT_THAT(ReasonOf(blocks, Wish(AngleKind::kRadius, 25.0_deg, 15.0)),
              HasSubstr("the trigger's travel ends at 36 mm"));
  wish = Wish(AngleKind::kRadius, 25.0_deg, 4.0);
  wish.muzzle_height_m = 1.5;
  EXPECT_THAT(ReasonOf(blocks, wish), HasSubstr("fall of 1486.6 mm alone"));
  wish.speed_mps = 8.0;
  EXPECT_THAT(ReasonOf(blocks, wish),
              HasSubstr("needs a muzzle height of 1500.0 mm"));
  wish.muzzle_height_m = 10.0_mm;
  EXPECT_THAT(ReasonOf(blocks, wish), HasSubstr("below the body's centre"));
  // Springs.
  blocks.compression_max_m.reset();
  blocks.springs.free_length_m.value() = 0.1;
  EXPECT_THAT(ReasonOf(blocks, Wish(AngleKind::kRadius, 25.0_deg, 15.0)),
              HasSubstr("exceeds the allowable 900 MPa"));
  blocks.springs.allowable_shear_pa.reset();
  EXPECT_THAT(ReasonOf(blocks, Wish(AngleKind::kRadius, 25.0_deg, 25.0)),
              HasSubstr("coil bind"));
}

// A muzzle that may stand lower than the body needs is raised, not refused.
TEST(SetPoints, DownwardFromLowMuzzlesIsPossible) {
  Description rig = Blocks();
  rig.muzzle_height_min_m = 0.0;
  const auto setting = FindSetting(rig, Wish(AngleKind::kFace, -20.0_deg, 4.0));
  ASSERT_TRUE(setting) << setting.error().reason;
  // Off the ground by three u of the height, and no higher than that needs.
  const double lowest = CentreHeightAtTouchdown(rig, setting->elevation_rad);
  EXPECT_NEAR(setting->muzzle_height_m - lowest, 3.0 * rig.u_muzzle_height_m,
              1e-9);
}

// Spins above sqrt(g / R), at which a corner falls faster than the centre.
TEST(SetPoints, FastSpinsArePlanned) {
  Description rig = Blocks();
  rig.body = core::Rectangle({120.0_mm, 0.0, {}}, {58.0_mm, 0.0, {}});
  rig.spin_rad_per_s.value = 3058.0_deg;
  std::mt19937_64 engine(1);
  int possible = 0;
  for (double deg = 26.0; deg <= 88.0; deg += 2.0) {
    const auto point = PlanContact(
        rig, Wish(AngleKind::kRadius, deg * core::kDegree, 4.0), kFew, engine);
    if (!point) continue;
    ++possible;
    EXPECT_NEAR(point->contact.radius_angle_rad.first_order->value,
                deg * core::kDegree, 1e-7);
  }
  EXPECT_GT(possible, 25);
}

TEST(SetPoints, ImpossibleWishThrows) {
  EXPECT_THROW(
      (void)FindSetting(Spheres(), Wish(AngleKind::kApproach, -1.0_deg, 4.0)),
      std::invalid_argument);
  EXPECT_THROW(
      (void)FindSetting(Spheres(), Wish(AngleKind::kApproach, 91.0_deg, 4.0)),
      std::invalid_argument);
  EXPECT_THROW(
      (void)FindSetting(Spheres(), Wish(AngleKind::kApproach, 20.0_deg, 0.0)),
      std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::rig
