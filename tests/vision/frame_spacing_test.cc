// vision/src/footage/formats/frame_spacing.h: what the times of frames say.
#include "vision/src/footage/formats/frame_spacing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace touchdown::vision {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr TimeErrors kTick{.tick_s = 1e-6};

std::vector<double> Grid(int frames, double fps) {
  std::vector<double> times;
  for (int i = 0; i < frames; ++i) times.push_back(i / fps);
  return times;
}

TEST(FrameSpacing, AStatedRateThatAgreesIsTaken) {
  const FrameSpacing spacing =
      FindSpacing(Grid(50, 999.9), {0.0, 1000.0}, kTick);
  EXPECT_TRUE(spacing.uniform);
  EXPECT_EQ(spacing.fps, 1000.0);
  EXPECT_THAT(spacing.times_s, IsEmpty());
  EXPECT_EQ(DescribeSpacing(spacing), "");
  EXPECT_NEAR(FindSpacing(Grid(50, 999.9), {900.0}, kTick).fps, 999.9, 1e-6);
  EXPECT_EQ(FindSpacing({}, {0.0, 25.0}, kTick).fps, 25.0);
  EXPECT_EQ(FindSpacing({0.0}, {}, kTick).fps, 0.0);
}

// Every number and place of lost frames, whatever the rate.
TEST(FrameSpacing, GapsAreCountedAndTimesAreWholePeriods) {
  for (const double fps : {30.0, 1000.0, 35087.7, 250000.0}) {
    for (const int missing : {1, 2, 7, 1000}) {
      for (const int after : {0, 10, 28}) {
        std::vector<double> times = Grid(30, fps);
        for (std::size_t i = static_cast<std::size_t>(after) + 1; i < 30; ++i) {
          times[i] += missing / fps;
        }
        const FrameSpacing spacing =
            FindSpacing(times, {fps}, {.jitter_s = 1e-9});
        EXPECT_FALSE(spacing.uniform);
        EXPECT_TRUE(spacing.even);
        EXPECT_EQ(spacing.fps, fps);
        ASSERT_EQ(spacing.gaps.size(), 1u);
        EXPECT_EQ(spacing.gaps[0].after, after);
        EXPECT_EQ(spacing.gaps[0].missing, missing);
        for (std::size_t i = 0; i < 30; ++i) {
          EXPECT_NEAR(spacing.times_s[i], times[i], 1e-9 / fps);
        }
      }
    }
  }
}

TEST(FrameSpacing, ManyGapsAreSaidInOneLine) {
  std::vector<double> times;
  for (int i = 0; i < 50; ++i) {
    if (i % 7 != 3) times.push_back(i * 0.01);
  }
  const FrameSpacing spacing = FindSpacing(times, {}, kTick);
  EXPECT_NEAR(spacing.fps, 100.0, 1e-9);
  EXPECT_EQ(DescribeSpacing(spacing),
            "7 frames are missing, dropped when they were recorded or saved (1 "
            "after frame 2, 1 after frame 8, 1 after frame 14, at 4 more "
            "places)");
}

// Jitter above rounding: no grid, but a missing frame is still seen.
TEST(FrameSpacing, AGapAmongUnevenFrames) {
  std::vector<double> times;
  for (int i = 0; i < 40; ++i) {
    if (i != 20) times.push_back(i * 0.01 + (i % 3 == 1 ? 0.0008 : 0.0));
  }
  const FrameSpacing spacing = FindSpacing(times, {100.0}, kTick);
  EXPECT_FALSE(spacing.even);
  ASSERT_EQ(spacing.gaps.size(), 1u);
  EXPECT_EQ(spacing.gaps[0].after, 19);
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_DOUBLE_EQ(spacing.times_s[i], times[i]);
  }
  EXPECT_THAT(DescribeSpacing(spacing), HasSubstr("not equally spaced"));
  EXPECT_THAT(DescribeSpacing(spacing), HasSubstr("1 frame is missing"));
}

TEST(FrameSpacing, IntervalsThatAreNoPeriodsAreNoGaps) {
  const FrameSpacing spacing =
      FindSpacing({0.0, 0.01, 0.02, 0.034, 0.044, 0.059}, {100.0}, kTick);
  EXPECT_FALSE(spacing.even);
  EXPECT_THAT(spacing.gaps, IsEmpty());
  EXPECT_NEAR(spacing.fps, 5 / 0.059, 1e-9);
}

// In .avi a tick is a period: one that is missing is no rounding. Where a tick
// is nearly a period, every tenth interval is two ticks, and nothing is
// missing.
TEST(FrameSpacing, ATickIsRoundingOnlyWhereThereIsSomethingToRound) {
  std::vector<double> times = Grid(30, 500.0);
  for (std::size_t i = 12; i < 30; ++i) times[i] += 0.002;
  const FrameSpacing avi = FindSpacing(times, {500.0}, {.tick_s = 0.002});
  ASSERT_EQ(avi.gaps.size(), 1u);
  EXPECT_EQ(avi.gaps[0].after, 11);
  EXPECT_TRUE(avi.even);
  for (const double fps : {900.0, 999.0, 640.0, 33.0}) {
    for (const double half : {0.0, 0.5}) {  // cut off, rounded
      std::vector<double> rounded = Grid(400, fps);
      for (double& t : rounded)
        t = std::floor(t * 1000.0 + half + 1e-9) / 1000.0;
      const FrameSpacing coarse =
          FindSpacing(rounded, {fps}, {.tick_s = 0.001});
      EXPECT_TRUE(coarse.uniform) << fps;
      EXPECT_EQ(coarse.fps, fps);
      EXPECT_TRUE(FindSpacing(rounded, {}, {.tick_s = 0.001}).gaps.empty());
    }
  }
}

TEST(FrameSpacing, AbsurdTimesAreNoCrash) {
  for (const double far : {1e300, 1e18, 1e9}) {
    const FrameSpacing spacing =
        FindSpacing({0.0, 1e-9, 2e-9, far}, {}, {.tick_s = 1e-12});
    EXPECT_FALSE(spacing.uniform);
    EXPECT_EQ(spacing.times_s.size(), 4u);
  }
  EXPECT_EQ(FindSpacing({0.0, 0.0, 0.0}, {}, kTick).fps, 0.0);
  FindSpacing({0.0, 0.0, 0.0, 1.0}, {}, kTick);
}

}  // namespace
}  // namespace touchdown::vision
