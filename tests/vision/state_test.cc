#include "touchdown/vision/contact/state.h"

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

}  // namespace
}  // namespace touchdown::vision
