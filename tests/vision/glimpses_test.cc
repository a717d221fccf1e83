#include "vision/src/detection/glimpses.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace touchdown::vision {
namespace {

constexpr std::int32_t kMargin = 2;

// A rectangle of so many cells and its margin, as a scout gives it.
core::PixelRect Cells(std::int32_t x, std::int32_t y, std::int32_t columns,
                      std::int32_t rows) {
  return {16 * (x - kMargin), 16 * (y - kMargin), 16 * (columns + 2 * kMargin),
          16 * (rows + 2 * kMargin)};
}

std::vector<std::int64_t> Range(std::int64_t first, std::int64_t last) {
  std::vector<std::int64_t> range;
  for (std::int64_t i = first; i < last; ++i) range.push_back(i);
  return range;
}

TEST(Glimpses, WhatLiesAroundOneThatShowsSomethingIsDecoded) {
  const std::vector<std::int64_t> glimpsed = {0, 16, 32, 48, 64, 80, 96};
  std::vector<bool> shows(glimpsed.size(), false);
  shows[3] = true;
  EXPECT_EQ(FramesWorthDecoding(0, 110, glimpsed, shows), Range(16, 81));
  GlimpseRule near;
  near.reach = 0;
  EXPECT_EQ(FramesWorthDecoding(0, 110, glimpsed, shows, near), Range(32, 64));
}

TEST(Glimpses, WithNothingSeenAllIsDecoded) {
  EXPECT_EQ(
      FramesWorthDecoding(5, 60, {5, 21, 37, 53}, {false, false, false, false}),
      Range(5, 60));
}

// A body may pass between two that are far apart, and beyond the last.
TEST(Glimpses, WhatLiesFarFromAnyIsDecoded) {
  std::vector<std::int64_t> expected = Range(16, 60);
  for (const std::int64_t i : Range(100, 140)) expected.push_back(i);
  GlimpseRule rule;
  rule.reach = 0;
  EXPECT_EQ(FramesWorthDecoding(0, 140, {0, 16, 60, 80, 100},
                                {true, false, false, false, false}, rule)
                .size(),
            16 + expected.size());
  const auto worth = FramesWorthDecoding(
      0, 140, {0, 16, 60, 80, 100}, {false, false, true, false, false}, rule);
  std::vector<std::int64_t> wanted = Range(16, 80);
  for (const std::int64_t i : Range(100, 140)) wanted.push_back(i);
  EXPECT_EQ(worth, wanted);
}

TEST(Glimpses, WhatStaysIsNoNoise) {
  const Changes here{{Cells(10, 10, 1, 1)}, 1.0};
  EXPECT_TRUE(AreInBoth(here, here, kMargin));
  EXPECT_TRUE(AreInBoth(here, {{Cells(11, 9, 1, 1)}, 1.0}, kMargin));
  EXPECT_FALSE(AreInBoth(here, {{Cells(14, 10, 1, 1)}, 1.0}, kMargin));
  EXPECT_FALSE(AreInBoth(here, {}, kMargin));
  // At the picture's border, where a margin is cut off.
  const Changes border{{{0, 160, 48, 80}}, 1.0};
  EXPECT_TRUE(AreInBoth(border, border, kMargin));
}

}  // namespace
}  // namespace touchdown::vision
