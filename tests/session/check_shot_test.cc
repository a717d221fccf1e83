#include "app/session/check_shot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace touchdown::session {
namespace {

using core::kDegree;
using ::testing::HasSubstr;

CheckShot Shot() {
  CheckShot check;
  check.body = core::Sphere({0.024, 0.00002, {}});
  check.height_m = {0.3, 0.001, {}};
  check.gravity_mps2 = {9.81, 0.0, {}};
  return check;
}

core::Trial Measured(double speed, double u_speed, double angle_deg) {
  core::Trial trial;
  trial.first.motion.before_speed_mps = core::Estimate{speed, u_speed, {}};
  trial.first.contact.approach_angle_rad =
      core::Estimate{angle_deg * kDegree, 0.1 * kDegree, {}};
  return trial;
}

TEST(CheckShot, KnownSpeedByHand) {
  // sqrt(2 * 9.81 * 0.3) = sqrt(5.886); u = v/2 * (1 mm / 300 mm).
  const auto known = ExpectedSpeed(Shot());
  EXPECT_NEAR(known.value, 2.426108, 1e-6);
  EXPECT_NEAR(known.u, 2.426108 / 600.0, 1e-6);
  CheckShot bad = Shot();
  bad.height_m.value = 0.0;
  EXPECT_THROW(ExpectedSpeed(bad), std::invalid_argument);
}

TEST(CheckShot, EnIsTheDifferenceOverTheExpandedUncertainty) {
  const auto known = ExpectedSpeed(Shot());
  // Off by exactly U = 2 sqrt(u^2 + u_known^2), then by a little more.
  const double u = 0.004;
  const double limit = 2.0 * std::hypot(u, known.u);
  for (const double factor : {-0.99, 0.0, 0.99}) {
    const auto result =
        Compare(Shot(), Measured(known.value + factor * limit, u, 89.9));
    EXPECT_NEAR(*result.speed_e_n, factor, 1e-12);
    EXPECT_TRUE(result.agrees) << result.text;
  }
  const auto fast =
      Compare(Shot(), Measured(known.value + 1.01 * limit, u, 90));
  EXPECT_FALSE(fast.agrees);
  EXPECT_THAT(fast.text, HasSubstr("DOES NOT AGREE"));
  // 88 deg: 2 deg off, U = 2 sqrt(0.1^2 + 0.3^2) = 0.632 deg.
  const auto slanted = Compare(Shot(), Measured(known.value, u, 88.0));
  EXPECT_NEAR(*slanted.angle_e_n, -2.0 / (2.0 * std::sqrt(0.1)), 1e-9);
  EXPECT_FALSE(slanted.agrees);
}

TEST(CheckShot, WhatWasNotMeasuredDoesNotAgree) {
  const auto result = Compare(Shot(), core::Trial());
  EXPECT_FALSE(result.agrees);
  EXPECT_THAT(result.text, HasSubstr("absent: no contact"));
}

TEST(CheckShot, ItsCampaignSaysBodyAndHeight) {
  const auto campaign = CheckCampaign(Shot());
  EXPECT_EQ(campaign.name, "check: sphere 24 mm from 300 mm");
  EXPECT_EQ(campaign.angle_kind, core::AngleKind::kApproach);
  CheckShot unknown;
  EXPECT_THROW(CheckCampaign(unknown), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::session
