#include "touchdown/rig/turning_flight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "touchdown/analysis/theory/rigid_motion.h"
#include "touchdown/core/units.h"

namespace touchdown::rig {
namespace {

using core::literals::operator""_deg;
using core::literals::operator""_mm;

TurningThrow Block(double elevation_rad, double spin_rad_per_s) {
  TurningThrow t;
  t.long_m = 120.0_mm;
  t.short_m = 58.0_mm;
  t.speed_mps = 4.0;
  t.elevation_rad = elevation_rad;
  t.height_m = 0.3;
  t.face_rad = elevation_rad;
  t.spin_rad_per_s = spin_rad_per_s;
  return t;
}

TEST(TurningFlight, WithoutSpinItIsTheParabola) {
  for (const double deg : {-60.0, -5.0, 0.0, 20.0, 70.0}) {
    const TurningThrow t = Block(deg * core::kDegree, 0.0);
    const auto flown = FlyTurning(t);
    ASSERT_TRUE(flown);
    const double centre = Land(t.long_m, t.short_m, t.face_rad).centre_height_m;
    const Flight f = Fly(4.0, t.elevation_rad, 0.3 - centre, t.gravity_mps2);
    EXPECT_NEAR(flown->flight.time_s, f.time_s, 1e-13);
    EXPECT_NEAR(flown->flight.approach_angle_rad, f.approach_angle_rad, 1e-12);
    EXPECT_NEAR(flown->flight.impact_speed_mps, f.impact_speed_mps, 1e-12);
    EXPECT_EQ(flown->face_rad, t.face_rad);
  }
}

TEST(TurningFlight, FirstTouchOfManyTurns) {
  // A block of 120 mm at 3058 deg/s: the fixed point of height, time and
  // attitude has several solutions, and only the first is a touchdown.
  std::mt19937_64 engine(11);
  std::uniform_real_distribution<double> spin(-80.0, 80.0);
  std::uniform_real_distribution<double> angle(-80.0_deg, 80.0_deg);
  int touched = 0;
  for (int i = 0; i < 300; ++i) {
    const TurningThrow t = Block(angle(engine), spin(engine));
    analysis::RigidMotionProblem p;
    p.body = core::Rectangle({t.long_m, 0.0, {}}, {t.short_m, 0.0, {}});
    p.start = {0.0,
               {0.0, t.height_m},
               t.face_rad,
               t.speed_mps * std::cos(t.elevation_rad),
               t.speed_mps * std::sin(t.elevation_rad),
               t.spin_rad_per_s};
    p.gravity_mps2 = t.gravity_mps2;
    p.end_s = 2.0;
    const auto truth = FirstTouchdown(SimulateRigidMotion(p));
    const auto flown = FlyTurning(t);
    ASSERT_TRUE(truth && flown) << i;
    ++touched;
    EXPECT_NEAR(flown->flight.time_s, truth->time_s, 1e-9) << i;
    EXPECT_NEAR(flown->face_rad, t.face_rad + t.spin_rad_per_s * truth->time_s,
                1e-7);
  }
  EXPECT_EQ(touched, 300);
}

TEST(TurningFlight, NoContactIsAValue) {
  TurningThrow t = Block(30.0_deg, 0.0);
  t.height_m = 0.01;
  EXPECT_NE(FlyTurning(t).error().reason.find("deep in the ground"),
            std::string::npos);
  // Level, just above the ground, thrown up slowly and turning fast: its tail
  // strikes while the centre rises.
  t = Block(80.0_deg, 60.0);
  t.face_rad = 0.0;
  t.height_m = 0.5 * t.short_m + 1e-4;
  t.speed_mps = 1.0;
  EXPECT_NE(FlyTurning(t).error().reason.find("still rises"),
            std::string::npos);
}

TEST(TurningFlight, ImpossibleInputIsRefused) {
  TurningThrow t = Block(0.0, 0.0);
  t.short_m = 0.2;
  EXPECT_THROW((void)FlyTurning(t), std::invalid_argument);
  t = Block(2.0, 0.0);
  EXPECT_THROW((void)FlyTurning(t), std::invalid_argument);
  t = Block(0.0, std::nan(""));
  EXPECT_THROW((void)FlyTurning(t), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::rig
