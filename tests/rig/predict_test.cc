#include "touchdown/rig/predict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "touchdown/core/units.h"
#include "touchdown/rig/flight.h"

namespace touchdown::rig {
namespace {

using core::literals::operator""_deg;
using core::literals::operator""_mm;
using testing::HasSubstr;

constexpr PredictOptions kFew{20'000};

Description Example() {
  return ParseDescription(ExampleDescription(), "example");
}

// A rig without uncertainties, throwing a point.
Description Exact() {
  Description rig = Example();
  SpringGeometry& g = *rig.springs.geometry;
  for (core::Estimate* e :
       {&g.shear_modulus_pa, &g.wire_diameter_m, &g.coil_diameter_m,
        &g.active_coils, &rig.efficiency, &rig.mass_kg, &rig.seat_angle_rad,
        &rig.spin_rad_per_s, &rig.gravity_mps2}) {
    e->u = 0.0;
  }
  rig.u_compression_m = rig.u_elevation_rad = rig.u_muzzle_height_m = 0.0;
  rig.body.reset();
  rig.efficiency.value = 1.0;
  return rig;
}

TEST(Predict, FollowsLaunchAndFlight) {
  const Description rig = Exact();
  std::mt19937_64 engine(1);
  const ContactPrediction c =
      Predict(rig, {50.0_mm, 0.0, 500.0_mm}, {2}, engine);  // SP01
  EXPECT_NEAR(c.launch_speed_mps.first_order->value, 13.271628881356258, 1e-13);
  EXPECT_NEAR(c.approach_angle_rad.first_order->value / core::kDegree,
              13.278785334840827, 1e-12);
  EXPECT_EQ(c.approach_angle_rad.first_order->u, 0.0);
  EXPECT_EQ(c.approach_angle_rad.monte_carlo->u, 0.0);
  EXPECT_FALSE(c.radius_angle_rad.first_order);
  EXPECT_EQ(c.radius_angle_rad.first_order.error().reason, "not a rectangle");
}

TEST(Predict, UncertaintyOfSpeedIsThatOfReference) {  // SP01's, without m_s
  Description rig = Exact();
  SpringGeometry& g = *rig.springs.geometry;
  g.shear_modulus_pa.u = 0.01 * g.shear_modulus_pa.value;
  g.wire_diameter_m.u = 0.005 * g.wire_diameter_m.value;
  g.active_coils.u = 0.01 * g.active_coils.value;
  g.coil_diameter_m.u = 0.005 * g.coil_diameter_m.value;
  rig.u_compression_m = 0.01 * 50.0_mm;
  rig.mass_kg.u = 0.002 * rig.mass_kg.value;
  rig.springs.mass_kg = core::Estimate{0.0, 0.0, {}};  // Eq. (10) has none
  std::mt19937_64 engine(12345);
  const Predicted v =
      Predict(rig, {50.0_mm, 0.0, 0.0}, {100'000}, engine).launch_speed_mps;
  EXPECT_NEAR(v.first_order->u / v.first_order->value, 0.018488383177011450,
              1e-8);
  EXPECT_NEAR(v.monte_carlo->u / v.first_order->value, 0.018511809268382490,
              5.0 * 0.0185 / std::sqrt(2e5));
  // The budget is the list of contributions, largest first: the wire's leads.
  ASSERT_EQ(v.budget.size(), 6u);
  EXPECT_EQ(v.budget[0].source, "wire diameter");
  EXPECT_NEAR(v.budget[0].u / v.first_order->value, 2.1875 * 0.005, 1e-8);
  double squares = 0.0;
  for (const auto& line : v.budget) squares += line.u * line.u;
  EXPECT_NEAR(std::sqrt(squares), v.first_order->u, 1e-15);
}

TEST(Predict, LevelShotForgetsItsElevation) {
  // d(approach)/d(elevation) = 0 at elevation 0 but for the work along the
  // barrel, 0.3 % of the elevation's u here.
  Description rig = Exact();
  rig.u_elevation_rad = 0.5_deg;
  std::mt19937_64 engine(1);
  const auto c = Predict(rig, {20.0_mm, 0.0, 300.0_mm}, kFew, engine);
  EXPECT_LT(c.approach_angle_rad.first_order->u, 0.01 * 0.5_deg);
  EXPECT_LT(c.approach_angle_rad.monte_carlo->u, 0.02 * 0.5_deg);
}

TEST(Predict, AttitudeIsKeptButForSpin) {
  Description rig = Example();
  std::mt19937_64 engine(1);
  const Setting setting{20.0_mm, 15.0_deg, 300.0_mm};
  const auto still = Predict(rig, setting, kFew, engine);
  EXPECT_NEAR(still.face_angle_rad.first_order->value, 15.0_deg, 1e-12);
  EXPECT_EQ(still.corner, core::Corner::kTrailing);
  EXPECT_NEAR(still.radius_angle_rad.first_order->value,
              15.0_deg + std::atan(20.0 / 60.0), 1e-12);
  const double t = still.flight_time_s.first_order->value;
  // u: elevation 0.2 deg, seat 0.3 deg, spin 5 deg/s over the flight.
  EXPECT_NEAR(still.face_angle_rad.first_order->u,
              std::hypot(0.2_deg, 0.3_deg, 5.0_deg * t), 1e-3 * 1.0_deg);
  rig.spin_rad_per_s.value = -120.0_deg;  // nose down: the other corner
  const auto spun = Predict(rig, setting, kFew, engine);
  EXPECT_NEAR(spun.face_angle_rad.first_order->value,
              15.0_deg - 120.0_deg * spun.flight_time_s.first_order->value,
              1e-9);
  EXPECT_EQ(spun.corner, core::Corner::kLeading);
}

TEST(Predict, FlushLandingIsNotNormal) {
  // |face| about 0: the radius angle cannot fall below atan(b/a), the first
  // order does not see it, the Monte Carlo does, and the corner is said to be
  // open.
  const Description rig = Example();
  std::mt19937_64 engine(1);
  const auto c = Predict(rig, {20.0_mm, 0.0, 300.0_mm}, kFew, engine);
  EXPECT_FALSE(c.radius_angle_rad.first_order_valid);
  EXPECT_GT(c.radius_angle_rad.monte_carlo->interval95.low,
            std::atan(20.0 / 60.0) - 0.1_deg);
  EXPECT_GT(c.radius_angle_rad.monte_carlo->u,
            10.0 * c.radius_angle_rad.first_order->u);
  bool said = false;
  for (const Finding& f : c.findings) {
    said = said || f.what.find("which corner lands first") != std::string::npos;
  }
  EXPECT_TRUE(said);
}

TEST(Predict, NotLeavingTheMuzzleIsAbsent) {
  Description rig = Exact();
  rig.mass_kg.value = 500.0;
  std::mt19937_64 engine(1);
  const auto c = Predict(rig, {10.0_mm, 90.0_deg, 300.0_mm}, kFew, engine);
  ASSERT_FALSE(c.launch_speed_mps.first_order);
  EXPECT_THAT(c.launch_speed_mps.first_order.error().reason,
              HasSubstr("does not leave the muzzle"));
  EXPECT_FALSE(c.approach_angle_rad.monte_carlo);
  EXPECT_EQ(c.p_no_contact, 1.0);
}

TEST(Predict, BarelyLeavingIsAMixture) {
  // Where the least compression is the one that is set, half of the draws stay.
  Description rig = Exact();
  rig.u_compression_m = 0.1_mm;
  const Launch launch = MakeLaunch(rig, 90.0_deg);
  std::mt19937_64 engine(1);
  const auto c = Predict(
      rig, {SolveCompression(launch, 0.0) * (1.0 + 1e-9), 90.0_deg, 0.3}, kFew,
      engine);
  EXPECT_NEAR(c.p_no_contact, 0.5, 0.02);
  ASSERT_FALSE(c.findings.empty());
  EXPECT_THAT(c.findings.back().what, HasSubstr("give no contact"));
}

TEST(Predict, StartingInTheGroundIsAbsent) {
  std::mt19937_64 engine(1);
  const auto c = Predict(Example(), {20.0_mm, 0.0, 5.0_mm}, {2}, engine);
  ASSERT_FALSE(c.impact_speed_mps.first_order);
  EXPECT_THAT(c.impact_speed_mps.first_order.error().reason,
              HasSubstr("deep in the ground"));
}

TEST(Predict, VerticalShotFoldsBack) {
  // Elevations beyond the vertical throw to the other side: the approach angle
  // stays below a right angle in every draw.
  Description rig = Exact();
  rig.u_elevation_rad = 1.0_deg;
  std::mt19937_64 engine(1);
  const auto c = Predict(rig, {20.0_mm, 90.0_deg, 0.3}, kFew, engine);
  ASSERT_TRUE(c.approach_angle_rad.monte_carlo);
  EXPECT_EQ(c.p_no_contact, 0.0);
  EXPECT_LE(c.approach_angle_rad.monte_carlo->interval95.high,
            std::numbers::pi / 2.0);
}

TEST(Predict, SameSeedSamePrediction) {
  std::mt19937_64 one(3);
  std::mt19937_64 other(3);
  const Setting setting{20.0_mm, 10.0_deg, 300.0_mm};
  const auto a = Predict(Example(), setting, {500}, one);
  const auto b = Predict(Example(), setting, {500}, other);
  EXPECT_EQ(a.range_m.monte_carlo->mean, b.range_m.monte_carlo->mean);
}

TEST(Predict, StiffnessAlone) {
  std::mt19937_64 engine(1);
  Description rig = Example();
  const Predicted h = PredictStiffness(rig, kFew, engine);
  EXPECT_NEAR(h.first_order->value, 7744.140625, 1e-9);
  // Exponents 1, 4 + 3 d/D_m, 1, 3 D_o/D_m.
  EXPECT_NEAR(h.first_order->u / h.first_order->value,
              std::sqrt(std::pow(0.8 / 79.3, 2) + std::pow(4.375 * 0.005, 2) +
                        std::pow(0.01, 2) + std::pow(3.375 * 0.005, 2)),
              1e-7);
  rig.springs.stiffness_n_per_m = core::Estimate{7000.0, 20.0, {}};
  const Predicted measured = PredictStiffness(rig, kFew, engine);
  EXPECT_EQ(measured.first_order->value, 7000.0);
  EXPECT_NEAR(measured.first_order->u, 20.0, 1e-8);
}

TEST(Predict, ImpossibleArgumentsThrow) {
  std::mt19937_64 engine(1);
  EXPECT_THROW((void)Predict(Example(), {-1.0_mm, 0.0, 0.3}, kFew, engine),
               std::invalid_argument);
  EXPECT_THROW((void)Predict(Example(), {1.0_mm, 100.0_deg, 0.3}, kFew, engine),
               std::invalid_argument);
  Description rig = Example();
  rig.mass_kg.value = 0.0;
  EXPECT_THROW((void)Predict(rig, {1.0_mm, 0.0, 0.3}, kFew, engine),
               std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::rig
