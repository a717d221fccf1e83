#include "touchdown/rig/flight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "touchdown/core/units.h"

namespace touchdown::rig {
namespace {

using core::Corner;
using core::literals::operator""_deg;

TEST(Flight, LevelShotFallsToItsAngle) {  // SP01, theory.md section 6
  const Flight f = Fly(13.271628881356258, 0.0, 0.5, 9.81);
  EXPECT_NEAR(f.approach_angle_rad / core::kDegree, 13.278785334840827, 1e-13);
  EXPECT_NEAR(f.impact_speed_mps, 13.636206699975238, 1e-14);
  EXPECT_NEAR(f.time_s, std::sqrt(2.0 * 0.5 / 9.81), 1e-16);
  EXPECT_NEAR(f.range_m, 4.2373049967544031, 1e-14);
}

TEST(Flight, LaunchAngleIsApproachAngleOnlyWithoutDrop) {
  for (const double deg : {1.0, 11.8, 45.0, 89.0}) {
    EXPECT_NEAR(Fly(5.0, deg * core::kDegree, 0.0).approach_angle_rad,
                deg * core::kDegree, 1e-15);
  }
  // SP04: 11.8 deg become 12.60.
  EXPECT_NEAR(Fly(31.173740346765917, 11.8_deg, 0.3, 9.81).approach_angle_rad /
                  core::kDegree,
              12.600097512692566, 1e-13);
}

TEST(Flight, StraightUpComesBackWithItsSpeed) {
  const Flight f = Fly(3.0, 90.0_deg, 0.0, 10.0);
  EXPECT_NEAR(f.time_s, 0.6, 1e-16);
  EXPECT_NEAR(f.impact_speed_mps, 3.0, 1e-15);
  EXPECT_NEAR(f.approach_angle_rad, std::numbers::pi / 2.0, 1e-15);
  EXPECT_NEAR(f.range_m, 0.0, 1e-15);
}

TEST(Flight, FollowsTheParabola) {
  for (const double deg : {-80.0, -30.0, -1.0, 0.0, 20.0, 70.0}) {
    for (const double drop : {1e-6, 0.1, 2.0}) {
      const double angle = deg * core::kDegree;
      const Flight f = Fly(4.0, angle, drop, 9.81);
      const double y =
          4.0 * std::sin(angle) * f.time_s - 0.5 * 9.81 * f.time_s * f.time_s;
      EXPECT_NEAR(y, -drop, 1e-14) << deg;
      EXPECT_NEAR(f.normal_mps, 9.81 * f.time_s - 4.0 * std::sin(angle), 1e-14);
      EXPECT_NEAR(f.range_m, 4.0 * std::cos(angle) * f.time_s, 1e-14);
      // Energy.
      EXPECT_NEAR(f.impact_speed_mps * f.impact_speed_mps,
                  16.0 + 2.0 * 9.81 * drop, 1e-13);
    }
  }
}

TEST(Flight, TimeKeepsItsDigitsFiredDownward) {
  // t = drop / v_down (1 - g drop / (2 v_down^2)) for a tiny drop.
  const Flight f = Fly(10.0, -90.0_deg, 1e-12, 9.81);
  EXPECT_NEAR(f.time_s, 1e-13 * (1.0 - 4.905e-14), 1e-28);
}

TEST(Flight, DroppedFromRest) {
  const Flight f = Fly(0.0, 30.0_deg, 0.2, 10.0);
  EXPECT_NEAR(f.approach_angle_rad, std::numbers::pi / 2.0, 1e-15);
  EXPECT_NEAR(f.impact_speed_mps, 2.0, 1e-15);
}

TEST(Flight, ImpossibleInputIsRefused) {
  EXPECT_THROW((void)Fly(-1.0, 0.0, 0.1), std::invalid_argument);
  EXPECT_THROW((void)Fly(1.0, 0.0, -0.1), std::invalid_argument);
  EXPECT_THROW((void)Fly(1.0, 2.0, 0.1), std::invalid_argument);
  EXPECT_THROW((void)Fly(1.0, 0.0, 0.1, 0.0), std::invalid_argument);
  EXPECT_THROW((void)Fly(std::nan(""), 0.0, 0.1), std::invalid_argument);
}

TEST(Landing, NoseUpLandsOnTheTrailingCorner) {
  const double diagonal = std::atan(20.0 / 60.0);
  for (const double deg : {0.5, 10.0, 45.0, 71.0}) {  // diagonal: 71.565 deg
    const double face = deg * core::kDegree;
    const Landing up = Land(0.06, 0.02, face);
    EXPECT_EQ(up.corner, Corner::kTrailing) << deg;
    EXPECT_NEAR(up.radius_angle_rad, face + diagonal, 1e-14);
    EXPECT_NEAR(up.centre_height_m,
                0.5 * std::hypot(0.06, 0.02) * std::sin(face + diagonal),
                1e-17);
    const Landing down = Land(0.06, 0.02, -face);
    EXPECT_EQ(down.corner, Corner::kLeading) << deg;
    EXPECT_EQ(down.radius_angle_rad, up.radius_angle_rad);
    EXPECT_EQ(down.centre_height_m, up.centre_height_m);
  }
}

TEST(Landing, SteeperThanTheDiagonalTheCornerChanges) {
  const double diagonal = std::atan(20.0 / 60.0);
  const Landing steep = Land(0.06, 0.02, 80.0_deg);
  EXPECT_EQ(steep.corner, Corner::kLeading);
  EXPECT_NEAR(steep.radius_angle_rad, std::numbers::pi - 80.0_deg - diagonal,
              1e-14);
  EXPECT_EQ(Land(0.06, 0.02, -80.0_deg).corner, Corner::kTrailing);
  // Balanced on the corner: neither.
  EXPECT_FALSE(Land(0.05, 0.05, 45.0_deg).corner.has_value());
  EXPECT_NEAR(Land(0.05, 0.05, 45.0_deg).radius_angle_rad,
              std::numbers::pi / 2.0, 1e-12);
}

TEST(Landing, FlushOnEitherSide) {
  EXPECT_EQ(Land(0.06, 0.02, 0.0).corner, Corner::kFlush);
  EXPECT_NEAR(Land(0.06, 0.02, 0.0).radius_angle_rad, std::atan2(1.0, 3.0),
              1e-15);
  EXPECT_NEAR(Land(0.06, 0.02, 0.0).centre_height_m, 0.01, 1e-17);
  EXPECT_EQ(Land(0.06, 0.02, 90.0_deg).corner, Corner::kFlush);
  EXPECT_NEAR(Land(0.06, 0.02, 90.0_deg).centre_height_m, 0.03, 1e-17);
}

TEST(Landing, ImpossibleInputIsRefused) {
  EXPECT_THROW((void)Land(0.02, 0.06, 0.0), std::invalid_argument);
  EXPECT_THROW((void)Land(0.02, 0.0, 0.0), std::invalid_argument);
  EXPECT_THROW((void)Land(0.06, 0.02, 2.0), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::rig
