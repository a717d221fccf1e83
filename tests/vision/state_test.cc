#include "touchdown/vision/state.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/support/statistics.h"

namespace touchdown::vision {
namespace {

using core::Estimate;
using core::MotionState;

constexpr double kG = 9.80665;

// The one rule: the 95 % interval above, below, or across the bounce height.
TEST(State, IntervalAboveBelowOrAcross) {
  const double height = 0.8;
  const double u = 0.1;
  const double half = core::kNormal975 * u;
  const auto label = [&](double value) {
    return DecideBounce({value, u, std::nullopt}, height).label;
  };
  EXPECT_EQ(label(height + half * 1.0001), MotionState::kBounce);
  EXPECT_EQ(label(height + half * 0.9999), MotionState::kUndecided);
  EXPECT_EQ(label(height), MotionState::kUndecided);
  EXPECT_EQ(label(height - half * 0.9999), MotionState::kUndecided);
  EXPECT_EQ(label(height - half * 1.0001), MotionState::kStaysDown);
}

// An interval of its own counts, not value +- 1.96 u.
TEST(State, StatedIntervalIsTheOneUsed) {
  Estimate gap{2.0, 0.1, core::Interval{0.5, 3.0}};
  EXPECT_EQ(DecideBounce(gap, 0.8).label, MotionState::kUndecided);
  gap.interval95 = core::Interval{0.81, 3.0};
  EXPECT_EQ(DecideBounce(gap, 0.8).label, MotionState::kBounce);
  gap.interval95 = core::Interval{0.1, 0.79};
  EXPECT_EQ(DecideBounce(gap, 0.8).label, MotionState::kStaysDown);
}

TEST(State, ProbabilityIsTheNormalOne) {
  EXPECT_NEAR(DecideBounce({1.0, 0.1, std::nullopt}, 1.0).p_bounce, 0.5, 1e-15);
  EXPECT_NEAR(DecideBounce({1.1, 0.1, std::nullopt}, 1.0).p_bounce,
              0.841344746068543, 1e-12);
  EXPECT_NEAR(DecideBounce({0.8, 0.1, std::nullopt}, 1.0).p_bounce,
              0.0227501319481792, 1e-12);
  // Exactly known: certain, never NaN, also on the very height.
  EXPECT_EQ(DecideBounce({1.1, 0.0, std::nullopt}, 1.0).p_bounce, 1.0);
  EXPECT_EQ(DecideBounce({0.9, 0.0, std::nullopt}, 1.0).p_bounce, 0.0);
  const auto edge = DecideBounce({1.0, 0.0, std::nullopt}, 1.0);
  EXPECT_EQ(edge.label, MotionState::kUndecided);
  EXPECT_TRUE(std::isfinite(edge.p_bounce));
}

// A label never contradicts the probability beside it.
TEST(State, LabelAndProbabilityAgree) {
  for (double value = -3.0; value <= 3.0; value += 0.01) {
    const auto e = DecideBounce({value, 0.5, std::nullopt}, 0.4);
    if (e.label == MotionState::kBounce) {
      EXPECT_GT(e.p_bounce, 0.975);
    } else if (e.label == MotionState::kStaysDown) {
      EXPECT_LT(e.p_bounce, 0.025);
    } else {
      EXPECT_GE(e.p_bounce, 0.0249);
      EXPECT_LE(e.p_bounce, 0.9751);
    }
  }
}

// statistics.md, section 5: what a recording can show at 2 and 1 px/mm.
TEST(State, DetectableGapOfTheTable) {
  struct Row {
    double px_per_mm, fps, noise_px, gap_mm;
  };
  const Row rows[] = {
      {2, 500, .05, .060},  {2, 500, .1, .105},  {2, 500, .3, .252},
      {2, 1000, .05, .046}, {2, 1000, .1, .079}, {2, 1000, .3, .191},
      {1, 1000, .05, .079}, {1, 1000, .1, .138}, {1, 1000, .3, .333}};
  for (const Row& row : rows) {
    const double gap_mm =
        1e3 *
        DetectableGap(1e-3 * row.noise_px / row.px_per_mm, row.fps, 0.0, kG);
    EXPECT_NEAR(gap_mm, row.gap_mm, 0.0006)
        << row.px_per_mm << " px/mm " << row.fps << " fps " << row.noise_px;
  }
  // At 250 frames a second three frames of flight are the limit: 0.18 mm.
  EXPECT_NEAR(1e3 * DetectableGap(2.5e-5, 250.0, 0.0, kG), 0.1765, 1e-4);
}

TEST(State, DetectableGapHoldsTheGroundsUncertainty) {
  const double alone = DetectableGap(5e-5, 1000.0, 0.0, kG);
  const double u = 2e-4;
  EXPECT_NEAR(DetectableGap(5e-5, 1000.0, u, kG), std::hypot(alone, 1.645 * u),
              1e-12);
  // Noise never helps, frames never harm.
  EXPECT_GT(DetectableGap(1e-4, 1000.0, 0.0, kG), alone);
  EXPECT_LT(DetectableGap(5e-5, 2000.0, 0.0, kG), alone);
}

std::vector<PlaneSample> Gaps(const std::vector<double>& gaps, double u) {
  std::vector<PlaneSample> samples;
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    PlaneSample s;
    s.frame = static_cast<std::int64_t>(i);
    s.time_s = static_cast<double>(i) * 1e-3;
    s.gap_px = gaps[i];
    s.u_gap_px = u;
    samples.push_back(s);
  }
  return samples;
}

TEST(State, GreatestGapOfAParabolaIsItsTop) {
  std::vector<double> gaps;
  for (int i = 0; i < 60; ++i) {
    const double t = i * 1e-3;
    gaps.push_back(300.0 * t - 0.5 * 9806.65 * t * t);
  }
  const auto greatest = FindGreatestGap(Gaps(gaps, 0.02), {}, 0.0);
  ASSERT_TRUE(greatest);
  EXPECT_NEAR(greatest->gap_px.value, 300.0 * 300.0 / (2 * 9806.65), 0.01);
  EXPECT_NEAR(static_cast<double>(greatest->at), 30.6, 1.0);
  EXPECT_FALSE(greatest->still_rising);
  // Above a ground elsewhere.
  const auto shifted = FindGreatestGap(Gaps(gaps, 0.02), {}, 1.5);
  EXPECT_NEAR(shifted->gap_px.value, greatest->gap_px.value - 1.5, 1e-12);
}

TEST(State, ClipThatEndsWhileTheBodyRisesSaysSo) {
  std::vector<double> gaps;
  for (int i = 0; i < 12; ++i) gaps.push_back(0.3 * i);
  EXPECT_TRUE(FindGreatestGap(Gaps(gaps, 0.02), {}, 0.0)->still_rising);
  // Rise within the noise is none.
  EXPECT_FALSE(FindGreatestGap(Gaps(gaps, 5.0), {}, 0.0)->still_rising);
  for (int i = 12; i < 24; ++i) gaps.push_back(0.3 * (24 - i));
  EXPECT_FALSE(FindGreatestGap(Gaps(gaps, 0.02), {}, 0.0)->still_rising);
}

TEST(State, FitsDoNotReachAcrossAContact) {
  // Two hops with a sharp kink at 20: a parabola across it would cut the tip
  // off or invent one.
  std::vector<double> gaps;
  for (int i = 0; i < 20; ++i) gaps.push_back(0.1 * (20 - i));
  for (int i = 20; i < 44; ++i) gaps.push_back(0.5 * (i - 20) * (43 - i) / 23);
  const std::vector<std::size_t> breaks = {20};
  const auto greatest = FindGreatestGap(Gaps(gaps, 0.02), breaks, 0.0);
  EXPECT_NEAR(greatest->gap_px.value, 0.5 * 11.5 * 11.5 / 23, 0.02);
}

TEST(State, NothingFilmedIsAbsent) {
  EXPECT_FALSE(FindGreatestGap({}, {}, 0.0));
  const auto one = FindGreatestGap(Gaps({1.25}, 0.1), {}, 0.0);
  ASSERT_TRUE(one);
  EXPECT_EQ(one->gap_px.value, 1.25);
  EXPECT_EQ(one->gap_px.u, 0.1);
}

// A body at rest whose height is noise: no false bounce at a bounce height of
// some standard deviations of a frame (the greatest of many noisy values would
// be one, were it taken at its face).
TEST(State, NoiseOfABodyAtRestIsNoBounce) {
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal;
  int bounces = 0;
  constexpr int kClips = 300;
  for (int k = 0; k < kClips; ++k) {
    std::vector<double> gaps;
    for (int i = 0; i < 200; ++i) gaps.push_back(0.1 * normal(engine));
    const auto greatest = FindGreatestGap(Gaps(gaps, 0.1), {}, 0.0);
    bounces +=
        DecideBounce(greatest->gap_px, 0.2).label == MotionState::kBounce;
  }
  EXPECT_EQ(bounces, 0);
}

}  // namespace
}  // namespace touchdown::vision
