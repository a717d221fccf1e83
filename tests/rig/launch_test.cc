#include "touchdown/rig/launch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

#include "touchdown/core/units.h"

namespace touchdown::rig {
namespace {

using core::literals::operator""_deg;
using testing::HasSubstr;

// The reference cases' baseline: H, m, m_s of SP01; g as they take it.
Launch Baseline() {
  Launch launch;
  launch.stiffness_n_per_m = 7744.140625;
  launch.mass_kg = 0.1;
  launch.spring_mass_kg = 0.029750935506643761;
  launch.gravity_mps2 = 9.81;
  return launch;
}

std::string MessageOf(const Launch& launch, double compression_m = 0.05) {
  try {
    (void)LaunchSpeed(launch, compression_m);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing thrown";
}

// A launch with every term switched on, at random.
Launch Any(std::mt19937_64& engine) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  Launch launch;
  launch.stiffness_n_per_m = std::exp(uniform(3.0, 11.0));
  launch.mass_kg = std::exp(uniform(-6.0, 0.0));
  launch.spring_mass_kg = uniform(0.0, 0.1);
  launch.preload_m = uniform(0.0, 0.02);
  launch.elevation_rad = uniform(-90.0_deg, 90.0_deg);
  launch.efficiency = uniform(0.5, 1.0);
  launch.barrel_friction = uniform(0.0, 0.5);
  launch.loss_j = uniform(0.0, 0.02);
  launch.gravity_mps2 = 9.81;
  return launch;
}

TEST(Launch, IdealSpeedByHand) {
  // 1 m, 4 N/m, 1 kg: 2 m/s; SP01: 0.05 sqrt(77441.40625) = 0.05 278.28296...
  EXPECT_DOUBLE_EQ(IdealLaunchSpeed(1.0, 4.0, 1.0), 2.0);
  EXPECT_NEAR(IdealLaunchSpeed(0.05, 7744.140625, 0.1), 13.914148038058244,
              1e-14);
  EXPECT_EQ(IdealLaunchSpeed(0.0, 4.0, 1.0), 0.0);
}

TEST(Launch, EqualsEquation10WithoutItsCorrections) {
  Launch launch = Baseline();
  launch.spring_mass_kg = 0.0;
  for (const double x : {1e-4, 0.01, 0.05, 0.3}) {
    const double ideal = IdealLaunchSpeed(x, 7744.140625, 0.1);
    EXPECT_NEAR(LaunchSpeed(launch, x)->speed_mps, ideal, 1e-15 * ideal);
    EXPECT_NEAR(LaunchSpeed(launch, x)->cancellation, 1.0, 1e-15);
  }
}

TEST(Launch, VerticalByHand) {  // SP03
  Launch launch = Baseline();
  launch.elevation_rad = 90.0_deg;
  // H X^2 = 19.3603515625; 2 (m + m_s/2) g X = 0.0981 + 0.0145928...
  const double lifted = 0.1 + 0.029750935506643761 / 2.0;
  const double moving = 0.1 + 0.029750935506643761 / 3.0;
  const double v =
      std::sqrt((19.3603515625 - 2.0 * lifted * 9.81 * 0.05) / moving);
  EXPECT_NEAR(LaunchSpeed(launch, 0.05)->speed_mps, v, 1e-14);
  EXPECT_NEAR(v, 13.232946726084068, 1e-13);  // the reference's 30 digits
}

TEST(Launch, SpringMassMattersForLightBodies) {  // SP04
  Launch launch = Baseline();
  launch.mass_kg = 0.01;
  launch.elevation_rad = 11.8_deg;
  const auto muzzle = LaunchSpeed(launch, 0.05);
  EXPECT_NEAR(muzzle->speed_mps, 31.173740346765917, 1e-13);
  ASSERT_EQ(muzzle->findings.size(), 1u);
  EXPECT_THAT(muzzle->findings[0].what, HasSubstr("outweigh the body"));
  launch.spring_mass_kg = 0.0;
  EXPECT_NEAR(LaunchSpeed(launch, 0.05)->speed_mps, 43.998119796454306, 1e-13);
}

TEST(Launch, PreloadAddsEnergy) {  // SP08: 40 mm beyond 10 mm
  Launch launch = Baseline();
  launch.preload_m = 0.01;
  launch.elevation_rad = 20.0_deg;
  const auto muzzle = LaunchSpeed(launch, 0.04);
  EXPECT_NEAR(muzzle->energy.spring_j, 9.29296875, 1e-14);
  EXPECT_NEAR(muzzle->speed_mps, 12.992696478868732, 1e-13);
}

TEST(Launch, BarelyLeavingWarns) {  // SP09
  Launch launch;
  launch.stiffness_n_per_m = 53.517438721520369;
  launch.mass_kg = 0.135;
  launch.spring_mass_kg = 0.0022371308925894235;
  launch.elevation_rad = 90.0_deg;
  launch.gravity_mps2 = 9.81;
  const auto muzzle = LaunchSpeed(launch, 0.05);
  // Cancellation of 1 part in 500: 1e-16 of the terms is 5e-14 of v^2.
  EXPECT_NEAR(muzzle->speed_mps, 0.043872606288372417, 2e-15);
  EXPECT_GT(muzzle->cancellation, 500.0);
  ASSERT_EQ(muzzle->findings.size(), 1u);
  EXPECT_THAT(muzzle->findings[0].what, HasSubstr("barely leaves the muzzle"));
}

TEST(Launch, NotLeavingTheMuzzleIsAValue) {  // SP12
  Launch launch;
  launch.stiffness_n_per_m = 53.517438721520369;
  launch.mass_kg = 1.0;
  launch.elevation_rad = 90.0_deg;
  const auto muzzle = LaunchSpeed(launch, 0.05);
  ASSERT_FALSE(muzzle);
  EXPECT_THAT(muzzle.error().reason, HasSubstr("does not leave the muzzle"));
  EXPECT_THAT(muzzle.error().reason, HasSubstr("gravity takes 0.49"));
  EXPECT_THAT(muzzle.error().reason, HasSubstr("compress by more than 366.5"));
  EXPECT_FALSE(LaunchSpeed(Baseline(), 0.0));
  // At the compression that the reason names the body just leaves.
  const double least = SolveCompression(launch, 0.0);
  EXPECT_FALSE(LaunchSpeed(launch, least * (1.0 - 1e-9)));
  EXPECT_TRUE(LaunchSpeed(launch, least * (1.0 + 1e-9)));
}

TEST(Launch, DownwardGravityHelps) {
  Launch launch = Baseline();
  const double level = LaunchSpeed(launch, 0.01)->speed_mps;
  launch.elevation_rad = -90.0_deg;
  const auto down = LaunchSpeed(launch, 0.01);
  EXPECT_GT(down->speed_mps, level);
  EXPECT_LT(down->energy.gravity_j, 0.0);
}

TEST(Launch, EnergyIsConserved) {
  std::mt19937_64 engine(7);
  int left = 0;
  for (int i = 0; i < 2000; ++i) {
    const Launch launch = Any(engine);
    const auto muzzle = LaunchSpeed(launch, 0.03);
    if (!muzzle) continue;
    ++left;
    const EnergyBalance& e = muzzle->energy;
    const double out =
        e.losses_j + e.gravity_j + e.friction_j + e.body_j + e.spring_motion_j;
    const double scale = e.spring_j + std::abs(e.gravity_j);
    ASSERT_NEAR(out, e.spring_j, 4e-15 * scale) << i;
  }
  EXPECT_GT(left, 1000);
}

TEST(Launch, BackwardsInvertsForwards) {
  std::mt19937_64 engine(11);
  int left = 0;
  for (int i = 0; i < 2000; ++i) {
    const Launch launch = Any(engine);
    for (const double x : {1e-4, 3e-3, 0.02, 0.2}) {
      const auto muzzle = LaunchSpeed(launch, x);
      if (!muzzle) continue;
      ++left;
      const double back = SolveCompression(launch, muzzle->speed_mps);
      ASSERT_NEAR(back, x, 1e-14 * muzzle->cancellation * x) << i;
    }
  }
  EXPECT_GT(left, 4000);
}

TEST(Launch, BackwardsIsStableAtSmallSpeedsUnderPreload) {
  // X = M v^2 / (2 H X0) to first order; the textbook root would lose all of
  // it.
  Launch launch = Baseline();
  launch.preload_m = 1.0;
  const double x = SolveCompression(launch, 1e-7);
  const double first = (0.1 + launch.spring_mass_kg / 3.0) * 1e-14 /
                       (2.0 * launch.stiffness_n_per_m);
  EXPECT_NEAR(x, first, 1e-14 * first);
}

TEST(Launch, ScalesWithUnits) {
  // Mass, stiffness and losses times k (another unit of mass): same speed.
  std::mt19937_64 engine(3);
  for (int i = 0; i < 200; ++i) {
    Launch launch = Any(engine);
    const auto one = LaunchSpeed(launch, 0.05);
    launch.mass_kg *= 1024.0;
    launch.spring_mass_kg *= 1024.0;
    launch.stiffness_n_per_m *= 1024.0;
    launch.loss_j *= 1024.0;
    const auto other = LaunchSpeed(launch, 0.05);
    ASSERT_EQ(one.has_value(), other.has_value());
    if (one) {
      ASSERT_EQ(one->speed_mps, other->speed_mps);
    }
  }
}

TEST(Launch, MoreCompressionIsMoreSpeed) {
  std::mt19937_64 engine(5);
  for (int i = 0; i < 200; ++i) {
    const Launch launch = Any(engine);
    double last = 0.0;
    for (double x = 0.001; x < 0.2; x *= 1.3) {
      const auto muzzle = LaunchSpeed(launch, x);
      if (!muzzle) {
        // Concave: once it leaves it leaves at every greater compression.
        ASSERT_EQ(last, 0.0);
        continue;
      }
      ASSERT_GT(muzzle->speed_mps, last);
      last = muzzle->speed_mps;
    }
  }
}

TEST(Launch, EfficiencyAboveOneWarns) {
  Launch launch = Baseline();
  launch.efficiency = 1.05;
  ASSERT_EQ(LaunchSpeed(launch, 0.05)->findings.size(), 1u);
  EXPECT_THAT(LaunchSpeed(launch, 0.05)->findings[0].what,
              HasSubstr("efficiency 1.05 is above 1"));
}

TEST(Launch, ImpossibleInputIsRefusedByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto with = [](double Launch::*field, double value) {
    Launch launch = Baseline();
    launch.*field = value;
    return MessageOf(launch);
  };
  EXPECT_THAT(with(&Launch::stiffness_n_per_m, 0.0),
              HasSubstr("stiffness_n_per_m is 0, must be positive"));
  EXPECT_THAT(with(&Launch::mass_kg, -1.0), HasSubstr("mass_kg is -1"));
  EXPECT_THAT(with(&Launch::spring_mass_kg, nan), HasSubstr("spring_mass_kg"));
  EXPECT_THAT(with(&Launch::preload_m, -1e-3), HasSubstr("preload_m"));
  EXPECT_THAT(with(&Launch::efficiency, 0.0), HasSubstr("efficiency is 0"));
  EXPECT_THAT(with(&Launch::barrel_friction, -0.1),
              HasSubstr("barrel_friction"));
  EXPECT_THAT(with(&Launch::loss_j, -0.1), HasSubstr("loss_j"));
  EXPECT_THAT(with(&Launch::gravity_mps2, nan), HasSubstr("gravity_mps2"));
  EXPECT_THAT(with(&Launch::elevation_rad, 91.0_deg),
              HasSubstr("elevation_rad"));
  EXPECT_THAT(MessageOf(Baseline(), -0.01),
              HasSubstr("compression_m is -0.01"));
  EXPECT_THROW((void)SolveCompression(Baseline(), -1.0), std::invalid_argument);
  EXPECT_THROW((void)IdealLaunchSpeed(-1.0, 1.0, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::rig
