#include "vision/src/outline/outline_sums.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace touchdown::vision {
namespace {

TEST(RobustScale, IsTheMedianAndAtLeastOne) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    std::mt19937_64 engine(seed);
    const double sigma =
        std::uniform_real_distribution<double>(0.8, 3.0)(engine);
    std::normal_distribution<double> noise(0.0, seed % 5 == 0 ? 1e3 : sigma);
    std::vector<double> residuals(1 + engine() % 300);
    for (double& r : residuals) r = noise(engine);
    std::vector<double> sizes;
    for (const double r : residuals) sizes.push_back(std::abs(r));
    std::sort(sizes.begin(), sizes.end());
    EXPECT_DOUBLE_EQ(RobustScale(residuals),
                     std::max(1.0, 1.4826 * sizes[sizes.size() / 2]))
        << seed;
  }
}

}  // namespace
}  // namespace touchdown::vision
