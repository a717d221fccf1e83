#include "touchdown/analysis/statistics/campaign_checks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

namespace touchdown::analysis {
namespace {

std::vector<core::Estimate> Drawn(std::mt19937_64& engine, int n, double truth,
                                  double u, double scatter) {
  std::normal_distribution<double> normal;
  std::vector<core::Estimate> out;
  for (int i = 0; i < n; ++i) {
    out.push_back({truth + scatter * normal(engine), u, {}});
  }
  return out;
}

TEST(PoolChecks, ByHand) {
  // Weights 4 : 1, no scatter beyond u: mean (4 * 1.02 + 1.04 ...)/..., plus 3
  // at the mean itself.
  const std::vector<core::Estimate> ratios = {{1.03, 0.01, {}},
                                              {1.03, 0.01, {}},
                                              {1.03, 0.02, {}},
                                              {1.03, 0.02, {}},
                                              {1.03, 0.02, {}}};
  const auto pooled = PoolChecks(ratios, 0.003);
  ASSERT_TRUE(pooled);
  EXPECT_EQ(pooled->trials, 5);
  EXPECT_NEAR(pooled->ratio.value, 1.03, 1e-15);
  EXPECT_NEAR(pooled->ratio.u,
              std::sqrt(1.0 / (2.0 / 1e-4 + 3.0 / 4e-4) + 9e-6), 1e-15);
  EXPECT_NEAR(pooled->z, 0.03 / pooled->ratio.u, 1e-12);
  EXPECT_TRUE(pooled->failed);
}

TEST(PoolChecks, ScatterWidens) {
  const std::vector<core::Estimate> ratios = {{0.9, 0.01, {}},
                                              {1.1, 0.01, {}},
                                              {0.9, 0.01, {}},
                                              {1.1, 0.01, {}},
                                              {1.0, 0.01, {}}};
  const auto pooled = PoolChecks(ratios, 0.0);
  ASSERT_TRUE(pooled);
  // chi^2 = 400 with 4 degrees: ten times as wide.
  EXPECT_NEAR(pooled->ratio.u, 10.0 * 0.01 / std::sqrt(5.0), 1e-12);
  EXPECT_FALSE(pooled->failed);
}

TEST(PoolChecks, TwentyAreSureWhereOneIsNot) {
  // 3 % off, 2 % each: one trial is at 1.5 u.
  std::mt19937_64 engine(5);
  int failed = 0;
  int wrongly = 0;
  for (int i = 0; i < 1000; ++i) {
    failed += PoolChecks(Drawn(engine, 20, 1.03, 0.02, 0.02), 0.002)->failed;
    wrongly += PoolChecks(Drawn(engine, 20, 1.0, 0.02, 0.02), 0.002)->failed;
  }
  EXPECT_GE(failed, 950);
  EXPECT_LE(wrongly, 10);
}

TEST(PoolChecks, WhatItShowsIsFoundInNinetyFiveOfHundred) {
  std::mt19937_64 engine(6);
  const double shows =
      PoolChecks(Drawn(engine, 20, 1.0, 0.01, 0.0), 0.0)->shows;
  int failed = 0;
  for (int i = 0; i < 2000; ++i) {
    failed +=
        PoolChecks(Drawn(engine, 20, 1.0 + shows, 0.01, 0.01), 0.0)->failed;
  }
  EXPECT_GE(failed, 1900);
  EXPECT_LE(failed, 1995);
}

TEST(PoolChecks, TooFewAreAbsent) {
  const std::vector<core::Estimate> ratios = {{1.0, 0.01, {}}};
  EXPECT_FALSE(PoolChecks(ratios, 0.0));
  EXPECT_FALSE(PoolChecks({}, 0.0));
  const std::vector<core::Estimate> bad(5, core::Estimate{1.0, 0.0, {}});
  EXPECT_THROW((void)PoolChecks(bad, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::analysis
