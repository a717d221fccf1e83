#include "touchdown/core/estimate.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchdown::core {
namespace {

TEST(Estimate, Interval95IsItsOwnOrTheNormalOne) {
  EXPECT_DOUBLE_EQ(Interval95({2.0, 0.5}).low, 2.0 - 0.5 * kNormal975);
  EXPECT_DOUBLE_EQ(Interval95({2.0, 0.5}).high, 2.0 + 0.5 * kNormal975);
  const Estimate own{2.0, 0.5, Interval{1.9, 4.0}};
  EXPECT_EQ(Interval95(own), (Interval{1.9, 4.0}));
}

TEST(Estimate, ScaledByANegativeFactorTurnsTheInterval) {
  const Estimate scaled = Scaled({2.0, 0.5, Interval{1.0, 4.0}}, -2.0);
  EXPECT_EQ(scaled.value, -4.0);
  EXPECT_EQ(scaled.u, 1.0);
  EXPECT_EQ(*scaled.interval95, (Interval{-8.0, -2.0}));
}

TEST(Combined, OfAgreeingMeasurementsIsTheWeightedMean) {
  // 1/u^2 = 1 + 4.
  const Estimate both = Combined({10.0, 1.0}, {10.5, 0.5});
  EXPECT_NEAR(both.value, (10.0 + 4.0 * 10.5) / 5.0, 1e-12);
  EXPECT_NEAR(both.u, 1.0 / std::sqrt(5.0), 1e-12);
}

// The one that claims more does not win: u reaches both.
TEST(Combined, OfConflictingMeasurementsCoversBoth) {
  const Estimate seen{88.406, 0.004};
  const Estimate stated{88.909, 0.089};
  const Estimate both = Combined(seen, stated);
  EXPECT_LT(std::abs(both.value - seen.value), kNormal975 * both.u);
  EXPECT_LT(std::abs(both.value - stated.value), kNormal975 * both.u);
  EXPECT_EQ(Combined(stated, seen), both);
  // tau^2 = (d^2 - u_a^2 - u_b^2) / 2 makes chi^2 = 1.
  const double tau2 = 0.5 * (0.503 * 0.503 - 0.004 * 0.004 - 0.089 * 0.089);
  EXPECT_NEAR(1.0 / (both.u * both.u),
              1.0 / (tau2 + 0.004 * 0.004) + 1.0 / (tau2 + 0.089 * 0.089),
              1e-6);
}

TEST(Combined, WithAConventionIsTheConvention) {
  const Estimate both = Combined({3.0, 0.0}, {3.0, 0.2});
  EXPECT_DOUBLE_EQ(both.value, 3.0);
  EXPECT_LT(both.u, 1e-8);
}

TEST(Disagreement, IsInUnitsOfTheDifferencesOwnU) {
  EXPECT_DOUBLE_EQ(Disagreement({1.0, 3.0}, {11.0, 4.0}), 2.0);
  EXPECT_DOUBLE_EQ(Disagreement({1.0, 0.0}, {1.0, 0.0}), 0.0);
}

}  // namespace
}  // namespace touchdown::core
