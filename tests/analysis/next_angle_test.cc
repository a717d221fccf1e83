#include "touchdown/analysis/statistics/next_angle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "touchdown/analysis/statistics/paper_table1.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {
namespace {

using core::BodyKind;
using core::kDegree;

TEST(ChooseNextAngle, AfterTable1ItGoesIntoTheBracket) {
  const auto posterior =
      FitBoundary(PaperTable1(BodyKind::kSphere, 0.5 * kDegree));
  const NextAngle next = ChooseNextAngle(posterior, 9);
  EXPECT_GT(next.angle_rad / kDegree, 12.0);
  EXPECT_LT(next.angle_rad / kDegree, 27.4);
  EXPECT_LT(next.expected_sd_rad, posterior.sd_rad);
  EXPECT_EQ(next.stop, StopReason::kNone);
  EXPECT_GT(next.trials_to_target, 5);
}

// The closed form p v1 + (1 - p) v0 against brute force: fit the two futures.
TEST(ChooseNextAngle, ExpectedSdIsThatOfTheTwoFutures) {
  std::vector<Observation> trials;
  for (const double x : {4.0, 8.0, 9.0, 11.0, 13.0, 18.0}) {
    trials.push_back(Observe(x * kDegree, 0.2 * kDegree, x > 10 || x == 8.0));
  }
  BoundaryFitOptions fit;
  fit.lapse_gain = HUGE_VAL;
  NextAngleOptions options;
  options.spread_rad = 0.0;
  options.set_u_rad = 0.3 * kDegree;
  const auto posterior = FitBoundary(trials, fit);
  const NextAngle next = ChooseNextAngle(posterior, 6, options);
  double expected = 0.0;
  double p_bounce = 0.0;
  for (std::size_t k = 0; k < posterior.grid.weight.size(); ++k) {
    const std::size_t m = posterior.grid.scatter_rad.size();
    const double s =
        std::hypot(posterior.grid.scatter_rad[k % m], options.set_u_rad);
    p_bounce += posterior.grid.weight[k] * 0.5 *
                std::erfc(-(next.angle_rad - posterior.grid.angle_rad[k / m]) /
                          s / std::sqrt(2.0));
  }
  for (const bool bounced : {false, true}) {
    auto future = trials;
    future.push_back(Observe(next.angle_rad, options.set_u_rad, bounced));
    const double sd = FitBoundary(future, fit).sd_rad;
    expected += (bounced ? p_bounce : 1 - p_bounce) * sd * sd;
  }
  EXPECT_NEAR(next.expected_sd_rad / std::sqrt(expected), 1.0, 2e-3);
}

TEST(ChooseNextAngle, BeginsInTheMiddleOfWhatIsFeasible) {
  NextAngleOptions options;
  options.spread_rad = 0.0;
  const NextAngle next = ChooseNextAngle(FitBoundary({}), 0, options);
  EXPECT_NEAR(next.angle_rad / kDegree, 45.0, 1.0);
}

TEST(ChooseNextAngle, StaysFeasibleAndSaysSo) {
  NextAngleOptions options;
  options.feasible_rad = {30 * kDegree, 40 * kDegree};
  std::vector<Observation> sharp;
  for (int i = 0; i < 40; ++i) {
    sharp.push_back(Observe((8.0 + 0.2 * i) * kDegree, 0.0, i > 20));
  }
  const NextAngle next = ChooseNextAngle(FitBoundary(sharp), 40, options);
  EXPECT_EQ(next.angle_rad, 30 * kDegree);
  EXPECT_TRUE(next.clipped);
}

// Whether the limits matter does not depend on the spread, which may lead away
// from the end that is thrown.
TEST(ChooseNextAngle, SaysThatTheLimitsMatterWhateverTheSpread) {
  std::vector<Observation> sharp;
  for (int i = 0; i < 40; ++i) {
    sharp.push_back(Observe((8.0 + 0.2 * i) * kDegree, 0.0, i > 20));
  }
  const BoundaryPosterior posterior = FitBoundary(sharp);
  NextAngleOptions options;
  options.forecast_futures = 0;
  for (int trials = 40; trials < 46; ++trials) {
    options.feasible_rad = {30 * kDegree, 40 * kDegree};
    EXPECT_TRUE(ChooseNextAngle(posterior, trials, options).clipped);
    options.feasible_rad = {10 * kDegree, 40 * kDegree};
    EXPECT_FALSE(ChooseNextAngle(posterior, trials, options).clipped);
  }
}

TEST(ChooseNextAngle, StopsAtTheTargetOrAtTheMaximum) {
  std::vector<Observation> sharp;
  for (int i = 0; i < 60; ++i) {
    sharp.push_back(Observe((8.0 + 0.1 * i) * kDegree, 0.0, i > 30));
  }
  const auto posterior = FitBoundary(sharp);
  const NextAngle next = ChooseNextAngle(posterior, 60);
  EXPECT_EQ(next.stop, StopReason::kTargetReached);
  EXPECT_EQ(next.trials_to_target, 0);
  const auto vague = FitBoundary(PaperTable1(BodyKind::kSphere, 0.0));
  NextAngleOptions options;
  options.max_trials = 9;
  EXPECT_EQ(ChooseNextAngle(vague, 9, options).stop, StopReason::kMaxTrials);
}

// The estimate's long tail must not choose the angle: five trials of a sharp
// boundary leave the design's reach narrower than the estimate's own.
TEST(ChooseNextAngle, ATighterPriorPlansWhatTheEstimateDoesNotKnow) {
  std::vector<Observation> trials;
  for (const double x : {35.0, 18.0, 9.0, 13.0, 11.0}) {
    trials.push_back(Observe(x * kDegree, 0.2 * kDegree, x > 12));
  }
  const auto posterior = FitBoundary(trials);
  NextAngleOptions options;
  options.spread_rad = 0.0;
  options.set_u_rad = 0.3 * kDegree;
  const NextAngle next = ChooseNextAngle(posterior, 5, options);
  EXPECT_GT(next.angle_rad / kDegree, 11.0);
  EXPECT_LT(next.angle_rad / kDegree, 13.0);
  // The same prior for both is the plain rule: the least of all candidates.
  options.design_scatter = posterior.prior;
  const NextAngle plain = ChooseNextAngle(posterior, 5, options);
  for (double c = 8.0; c <= 20.0; c += 0.5) {
    EXPECT_LE(plain.expected_sd_rad,
              ExpectedSd(posterior, c * kDegree, options) * (1 + 1e-9))
        << c;
  }
}

TEST(ForecastTrials, IsNothingWhereTheTargetIsReached) {
  std::mt19937_64 engine(1);
  const auto posterior = FitBoundary(PaperTable1(BodyKind::kSphere, 0.0));
  EXPECT_EQ(ForecastTrials(posterior, {40 * kDegree, 0.0}, engine), 0);
  EXPECT_GE(ForecastTrials(posterior, {9 * kDegree, 0.0}, engine), 1);
}

TEST(ForecastTrials, GrowsAsTheTargetShrinksAndIsRepeatable) {
  const auto posterior =
      FitBoundary(PaperTable1(BodyKind::kRectangle, 0.2 * kDegree));
  int last = 0;
  for (const double target_deg : {5.0, 2.0, 1.0, 0.5, 0.1}) {
    std::mt19937_64 engine(4);
    std::mt19937_64 again(4);
    const ForecastOptions options{target_deg * kDegree, 0.3 * kDegree};
    const int n = ForecastTrials(posterior, options, engine);
    EXPECT_EQ(n, ForecastTrials(posterior, options, again));
    EXPECT_GE(n, last) << target_deg;
    last = n;
  }
  EXPECT_GT(last, 20);
}

// After ten trials that closed in on a sharp boundary about ten more are
// needed (simulated: 8 to 16 in nine of ten runs).
TEST(ForecastTrials, ASharpBoundaryNeedsFewMore) {
  std::vector<Observation> trials;
  for (const double x :
       {35.0, 18.0, 9.0, 13.5, 11.2, 12.4, 11.8, 12.2, 11.6, 12.1}) {
    trials.push_back(Observe(x * kDegree, 0.2 * kDegree, x > 12));
  }
  std::mt19937_64 engine(2);
  const int n = ForecastTrials(FitBoundary(trials),
                               {0.5 * kDegree, 0.3 * kDegree}, engine);
  EXPECT_GE(n, 3);
  EXPECT_LE(n, 25);
}

TEST(ForecastTrials, NoTrialsIsAForecastToo) {
  std::mt19937_64 engine(3);
  const int n = ForecastTrials(FitBoundary({}), {}, engine);
  EXPECT_GE(n, 8);
  EXPECT_LE(n, 1000000);
}

TEST(ForecastTrials, RefusesImpossibleOptionsByName) {
  std::mt19937_64 engine(1);
  const auto posterior = FitBoundary({});
  EXPECT_THROW(ForecastTrials(posterior, {0.0, 0.1}, engine),
               std::invalid_argument);
  EXPECT_THROW(ForecastTrials(posterior, {0.1, -0.1}, engine),
               std::invalid_argument);
}

TEST(ChooseNextAngle, RefusesImpossibleOptionsByName) {
  const auto posterior = FitBoundary({});
  NextAngleOptions options;
  options.feasible_rad = {1.0, 0.5};
  EXPECT_THROW(ChooseNextAngle(posterior, 0, options), std::invalid_argument);
  options = {};
  options.target_half_width_rad = 0.0;
  EXPECT_THROW(ChooseNextAngle(posterior, 0, options), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::analysis
