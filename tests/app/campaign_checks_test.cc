#include "app/facts/campaign_checks.h"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using ::testing::HasSubstr;

// Twenty trials whose gravity and size come out at these shares, with 1 % and
// 0.1 % of noise.
struct Made {
  double gravity = 1.0;  // 0: not to be measured
  double size = 1.0;
  std::string scale_from = "user";
};

std::vector<core::Trial> Trials(const Made& made, std::uint64_t seed = 1) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<core::Trial> out;
  for (int i = 0; i < 20; ++i) {
    core::Trial trial;
    if (made.gravity > 0.0) {
      trial.first.motion.gravity_check_mps2 = core::Estimate{
          core::kStandardGravity_mps2 * (made.gravity + 0.01 * normal(engine)),
          0.01 * core::kStandardGravity_mps2,
          {}};
    } else {
      trial.first.motion.gravity_check_mps2 =
          core::AbsentBecause("the flight is too short");
    }
    trial.document_json = fmt::format(
        R"({{"clip": {{"time_base": {{"fps": 2000.0}}}},
            "scale": {{"px_per_m": {{"value": 1000.0, "u": 1.0}},
                       "source": "{}"}},
            "body": {{"diameter_mm": {{"value": 40.0, "u": 0.04}},
                      "radius_px": {{"value": {}, "u": 0.02}}}}}})",
        made.scale_from, 20.0 * made.size + 0.02 * normal(engine));
    out.push_back(trial);
  }
  return out;
}

CampaignChecks Checked(const std::vector<core::Trial>& trials) {
  std::vector<std::size_t> members(trials.size());
  std::iota(members.begin(), members.end(), std::size_t{0});
  return CheckCampaign(members, trials);
}

TEST(CampaignChecks, RightTrialsPassAndSayWhatWouldShow) {
  const auto checks = Checked(Trials({}));
  EXPECT_FALSE(checks.Failed()) << checks.explanation;
  ASSERT_TRUE(checks.gravity && checks.size);
  EXPECT_EQ(checks.gravity->trials, 20);
  EXPECT_LT(checks.gravity->shows, 0.02);
  EXPECT_THAT(WhatChecksShow(checks), HasSubstr("in the frame rate"));
}

TEST(CampaignChecks, AScaleExplainsBoth) {
  const auto checks = Checked(Trials({.gravity = 1.03, .size = 1.03}));
  EXPECT_THAT(checks.explanation, HasSubstr("would explain both"));
  EXPECT_THAT(checks.explanation, HasSubstr("instead of 1000.0"));
}

TEST(CampaignChecks, AFrameRateLeavesTheSizeAlone) {
  // Told 2 % too high: accelerations come out 4 % too large.
  const auto checks = Checked(Trials({.gravity = 1.02 * 1.02}));
  EXPECT_THAT(checks.explanation, HasSubstr("a frame rate of 19"));
  EXPECT_THAT(checks.explanation, HasSubstr("the size agrees"));
}

TEST(CampaignChecks, ABodyIsSmallerThanStated) {
  const auto checks = Checked(Trials({.size = 0.95}));
  EXPECT_THAT(checks.explanation, HasSubstr("a body of 0.95"));
  EXPECT_THAT(checks.explanation, HasSubstr("gravity agrees with the scale"));
}

TEST(CampaignChecks, AScaleFromTheBodyIsCheckedByGravityAlone) {
  // Stated 5 % too large: the scale is 5 % too small, gravity too large.
  const auto checks =
      Checked(Trials({.gravity = 1.0 / 0.95, .scale_from = "body_size"}));
  EXPECT_FALSE(checks.size);
  EXPECT_THAT(checks.explanation, HasSubstr("times the stated size"));
}

// The scale is in both speeds alike: what makes every rebound faster than the
// approach is the line, and nothing else may be blamed.
TEST(CampaignChecks, RestitutionAboveOneAccusesTheGroundLineAlone) {
  auto trials = Trials({});
  for (core::Trial& trial : trials) {
    trial.first.motion.restitution = core::Estimate{1.08, 0.02, {}};
  }
  const auto checks = Checked(trials);
  EXPECT_THAT(checks.explanation, HasSubstr("a ground line"));
  EXPECT_EQ(checks.Suspects(), "the ground line");
  EXPECT_EQ(Checked(Trials({.gravity = 1.03, .size = 1.03})).Suspects(),
            "scale, frame rate or size");
  EXPECT_EQ(Checked(Trials({})).Suspects(), "");
}

TEST(CampaignChecks, ADocumentWithoutAScaleIsNoMissingDocument) {
  auto trials = Trials({});
  for (core::Trial& trial : trials) trial.document_json = "{}";
  const auto checks = Checked(trials);
  ASSERT_FALSE(checks.size);
  EXPECT_THAT(checks.size.error().reason, HasSubstr("holds no scale"));
}

TEST(CampaignChecks, WhereNothingCanShowItSaysSo) {
  const auto checks =
      Checked(Trials({.gravity = 0, .scale_from = "body_size"}));
  EXPECT_FALSE(checks.Failed());
  EXPECT_THAT(WhatChecksShow(checks),
              HasSubstr("Nothing in these trials can show"));
  EXPECT_THAT(WhatChecksShow(checks), HasSubstr("the flight is too short"));
}

TEST(CampaignChecks, ExcludedAndTypedTrialsDoNotCount) {
  auto trials = Trials({.gravity = 1.2});
  for (core::Trial& trial : trials) trial.excluded = true;
  EXPECT_FALSE(Checked(trials).gravity);
  for (core::Trial& trial : trials) {
    trial.excluded = false;
    trial.origin = core::Origin::kManual;
  }
  EXPECT_FALSE(Checked(trials).Failed());
}

TEST(CampaignChecks, ADamagedDocumentIsNoDocument) {
  auto trials = Trials({});
  for (core::Trial& trial : trials) trial.document_json = "{\"scale\": [";
  const auto checks = Checked(trials);
  EXPECT_FALSE(checks.size);
  EXPECT_TRUE(checks.gravity);
}

TEST(CampaignChecks, WrongCampaignsAreFlaggedRightOnesAreNot) {
  int found = 0;
  int wrongly = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    found += Checked(Trials({.gravity = 1.03, .size = 1.03}, seed)).Failed();
    wrongly += Checked(Trials({}, seed)).Failed();
  }
  EXPECT_GE(found, 285);
  EXPECT_LE(wrongly, 3);
}

}  // namespace
}  // namespace touchdown::report
