#include "touchdown/core/normal.h"

#include <gtest/gtest.h>

#include <cmath>

#include "touchdown/core/estimate.h"

namespace touchdown::core {
namespace {

TEST(NormalCdf, HasTheValuesOfTheTables) {
  EXPECT_DOUBLE_EQ(NormalCdf(0.0), 0.5);
  EXPECT_NEAR(NormalCdf(kNormal975), 0.975, 1e-15);
  // Abramowitz and Stegun, table 26.1.
  EXPECT_NEAR(NormalCdf(1.0), 0.841344746068543, 1e-15);
}

// Mills' ratio (Abramowitz and Stegun 26.2.12): relative accuracy is kept where
// 1 - Phi(-z) would have none.
TEST(NormalCdf, IsAccurateInTheLowerTail) {
  for (const double z : {20.0, 30.0, 37.0}) {
    const double w = 1.0 / (z * z);
    const double series = 1.0 - w * (1.0 - w * (3.0 - w * (15.0 - 105.0 * w)));
    EXPECT_NEAR(NormalCdf(-z) * z / NormalDensity(z) / series, 1.0, 1e-9) << z;
  }
}

TEST(NormalDensity, IsTheDerivative) {
  constexpr double kStep = 1e-5;
  for (const double z : {-3.0, -0.5, 0.0, 1.7}) {
    EXPECT_NEAR((NormalCdf(z + kStep) - NormalCdf(z - kStep)) / (2.0 * kStep),
                NormalDensity(z), 1e-10)
        << z;
  }
}

}  // namespace
}  // namespace touchdown::core
