#include "touchdown/analysis/statistics/special_functions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "touchdown/core/normal.h"

namespace touchdown::analysis {
namespace {

TEST(LogNormalCdf, AsymptoticTail) {
  // statistics.md 1.2.
  EXPECT_NEAR(LogNormalCdf(-10) / -53.23128515, 1.0, 1e-10);
  EXPECT_NEAR(LogNormalCdf(-40) / -804.6084420, 1.0, 1e-10);
  EXPECT_NEAR(LogNormalCdf(-1e3) / -500007.8266948, 1.0, 1e-12);
  EXPECT_NEAR(LogNormalCdf(-1e8) / -5.00000000000002e15, 1.0, 1e-14);
}

TEST(LogNormalCdf, IsSmoothAcrossItsBranches) {
  for (const double z : {-30.0, 5.0}) {
    const double below = LogNormalCdf(z - 1e-9);
    const double above = LogNormalCdf(z + 1e-9);
    EXPECT_LE(below, above);
    EXPECT_NEAR(below, above, 1e-7);
  }
  EXPECT_DOUBLE_EQ(LogNormalCdf(0.0), std::log(0.5));
  EXPECT_EQ(LogNormalCdf(50.0), 0.0);
}

TEST(NormalQuantile, InvertsTheDistribution) {
  EXPECT_NEAR(NormalQuantile(0.975), 1.959963984540054, 1e-14);
  EXPECT_NEAR(NormalQuantile(0.95), 1.6448536269514722, 1e-14);
  for (double p = 1e-12; p < 1.0; p = p < 0.01 ? p * 7 : p + 0.013) {
    EXPECT_NEAR(core::NormalCdf(NormalQuantile(p)) / p, 1.0, 1e-12) << p;
  }
  EXPECT_THROW(NormalQuantile(0.0), std::invalid_argument);
  EXPECT_THROW(NormalQuantile(1.0), std::invalid_argument);
}

TEST(RegularizedBeta, ClosedForms) {
  for (double x = 0.0; x <= 1.0; x += 0.05) {
    EXPECT_NEAR(RegularizedBeta(1, 1, x), x, 1e-14);
    EXPECT_NEAR(RegularizedBeta(3, 1, x), x * x * x, 1e-14);
    EXPECT_NEAR(RegularizedBeta(2.5, 4, x) + RegularizedBeta(4, 2.5, 1 - x), 1,
                1e-13);
  }
}

TEST(BetaQuantile, InvertsOverAGrid) {
  for (const double a : {0.5, 1.0, 7.0, 300.0}) {
    for (const double b : {0.5, 2.0, 40.0}) {
      for (const double p : {0.001, 0.025, 0.5, 0.975}) {
        EXPECT_NEAR(RegularizedBeta(a, b, BetaQuantile(a, b, p)), p, 1e-11);
      }
    }
  }
}

TEST(BinomialProbability, SumsToOne) {
  for (const double p : {0.0, 0.1, 0.5, 1.0}) {
    double sum = 0.0;
    for (int k = 0; k <= 30; ++k) sum += BinomialProbability(k, 30, p);
    EXPECT_NEAR(sum, 1.0, 1e-12);
  }
}

}  // namespace
}  // namespace touchdown::analysis
