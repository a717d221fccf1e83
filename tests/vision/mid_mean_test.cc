#include "vision/src/background/mid_mean.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

namespace touchdown::vision {
namespace {

// Every number of samples up to 40: each pixel's own, against std::sort.
template <class Sample>
void ExpectSorted(SortingNetwork::Order order) {
  std::mt19937_64 engine(7);
  for (std::size_t n = 1; n <= 40; ++n) {
    std::vector<Sample> lanes(n * kLanes);
    for (Sample& v : lanes) v = static_cast<Sample>(engine());
    const std::vector<Sample> before = lanes;
    SortingNetwork(n, order).Sort(lanes.data());
    for (std::size_t i = 0; i < kLanes; ++i) {
      std::vector<Sample> expected;
      std::vector<Sample> got;
      for (std::size_t k = 0; k < n; ++k) {
        expected.push_back(before[k * kLanes + i]);
        got.push_back(lanes[k * kLanes + i]);
      }
      std::sort(expected.begin(), expected.end());
      if (order == SortingNetwork::Order::kMiddle) {
        // The middle ones in any order.
        const auto cut = static_cast<std::ptrdiff_t>(MidBegin(n));
        expected = {expected.begin() + cut, expected.end() - cut};
        got = {got.begin() + cut, got.end() - cut};
        std::sort(got.begin(), got.end());
      }
      ASSERT_EQ(got, expected) << n << " samples, pixel " << i;
    }
  }
}

TEST(SortingNetwork, SortsEachPixel) {
  ExpectSorted<std::uint8_t>(SortingNetwork::Order::kFull);
  ExpectSorted<std::uint16_t>(SortingNetwork::Order::kFull);
  ExpectSorted<float>(SortingNetwork::Order::kFull);
}

TEST(SortingNetwork, TheMiddleIsInTheMiddle) {
  ExpectSorted<std::uint8_t>(SortingNetwork::Order::kMiddle);
  ExpectSorted<std::uint16_t>(SortingNetwork::Order::kMiddle);
}

TEST(SortingNetwork, HalfOfManyAllOfTwo) {
  EXPECT_EQ(MidBegin(1), 0u);
  EXPECT_EQ(MidBegin(2), 0u);
  EXPECT_EQ(MidBegin(4), 1u);
  EXPECT_EQ(MidBegin(33), 8u);
}

}  // namespace
}  // namespace touchdown::vision
