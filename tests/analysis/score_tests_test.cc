#include "touchdown/analysis/statistics/score_tests.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "touchdown/core/units.h"

namespace touchdown::analysis {
namespace {

using core::kDegree;

struct Sequence {
  std::vector<Observation> trials;
  std::vector<std::optional<double>> order;
};

// n trials near 12 deg, the boundary drifting by `drift_deg` from first to
// last.
Sequence Drifting(int n, double drift_deg, std::mt19937_64& engine) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(9.0, 15.0);
  Sequence out;
  for (int i = 0; i < n; ++i) {
    const double x = uniform(engine);
    const double order = static_cast<double>(i) / (n - 1);
    const bool bounced =
        x > 12.0 + drift_deg * (order - 0.5) + 1.0 * normal(engine);
    out.trials.push_back(Observe(x * kDegree, 0.2 * kDegree, bounced));
    out.order.push_back(order);
  }
  return out;
}

BoundaryPosterior Fit(const std::vector<Observation>& trials) {
  BoundaryFitOptions options;
  options.sensitivity.clear();
  return FitBoundary(trials, options);
}

// Rao's score for one weight, by hand: two angles at +-1 sigma, covariate +-1
// crosswise, so that neither boundary nor scatter can take it up.
TEST(TestCovariate, IsRaosScore) {
  BoundaryPosterior posterior;
  posterior.median_rad = 0.2;
  posterior.scatter_median_rad = 0.01;
  std::vector<Observation> trials;
  std::vector<std::optional<double>> covariate;
  for (int i = 0; i < 16; ++i) {
    const double z = i % 2 == 0 ? 1.0 : -1.0;
    const double c = i % 4 < 2 ? 1.0 : -1.0;
    trials.push_back(Observe(0.2 + 0.01 * z, 0.0, c > 0.0 ? 0.0 : 1.0));
    covariate.push_back(c);
  }
  const auto test = TestCovariate(trials, covariate, posterior);
  ASSERT_TRUE(test.has_value());
  // phi(1) = 0.24197072, Phi(1) = 0.84134475: the covariate's residuals are
  // -Phi(z) with c = 1, 1 - Phi(z) with c = -1, for all of which sum |p - P| c
  // = -16 / 2.
  const double phi = 0.24197072451914337;
  const double variance = 0.8413447460685429 * 0.15865525393145707;
  const double expected =
      8.0 * phi / variance / std::sqrt(16.0 * phi * phi / variance);
  EXPECT_NEAR(test->z, expected, 1e-9);
  EXPECT_GT(test->slope_rad, 0.0);
  EXPECT_EQ(test->trials, 16);
}

TEST(TestCovariate, RejectsByChanceAsOftenAsItSays) {
  std::mt19937_64 engine(5);
  constexpr int kRuns = 400;
  int rejected = 0;
  for (int run = 0; run < kRuns; ++run) {
    const Sequence s = Drifting(40, 0.0, engine);
    const auto test = TestCovariate(s.trials, s.order, Fit(s.trials));
    ASSERT_TRUE(test.has_value());
    rejected += test->p < 0.05 ? 1 : 0;
  }
  // 20 of 400, give or take three standard deviations.
  EXPECT_GE(rejected, 7);
  EXPECT_LE(rejected, 33);
}

TEST(TestCovariate, FindsADrift) {
  std::mt19937_64 engine(6);
  int found = 0;
  double slope = 0.0;
  for (int run = 0; run < 40; ++run) {
    const Sequence s = Drifting(100, 2.5, engine);
    const auto test = TestCovariate(s.trials, s.order, Fit(s.trials));
    found += test->p < 0.05 && test->z > 0.0 ? 1 : 0;
    slope += test->slope_rad / kDegree / 40;
  }
  EXPECT_GE(found, 36);
  EXPECT_NEAR(slope, 2.5, 0.6);
}

TEST(TestCovariate, SaysNothingWithoutVariationOrTrials) {
  std::mt19937_64 engine(7);
  Sequence s = Drifting(30, 0.0, engine);
  const auto posterior = Fit(s.trials);
  EXPECT_FALSE(TestCovariate(s.trials,
                             std::vector<std::optional<double>>(30, 3.0),
                             posterior)
                   .has_value());
  for (std::size_t i = 0; i < 25; ++i) s.order[i].reset();
  EXPECT_FALSE(TestCovariate(s.trials, s.order, posterior).has_value());
  EXPECT_THROW(TestCovariate(s.trials, {}, posterior), std::invalid_argument);
}

TEST(TestNames, FindsTheSurfaceThatStandsOut) {
  std::mt19937_64 engine(8);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(9.0, 15.0);
  std::vector<Observation> trials;
  std::vector<std::string> names;
  for (int i = 0; i < 120; ++i) {
    const std::string name = i % 3 == 0 ? "wet" : i % 3 == 1 ? "dry" : "dusty";
    const double x = uniform(engine);
    const bool bounced =
        x > (name == "wet" ? 13.5 : 11.5) + 0.5 * normal(engine);
    trials.push_back(Observe(x * kDegree, 0.2 * kDegree, bounced));
    names.push_back(name);
  }
  const auto test = TestNames(trials, names, Fit(trials));
  ASSERT_TRUE(test.has_value());
  EXPECT_EQ(test->name, "wet");
  EXPECT_LT(test->test.p, 0.001);
  EXPECT_FALSE(
      TestNames(trials, std::vector<std::string>(120, "dry"), Fit(trials))
          .has_value());
}

}  // namespace
}  // namespace touchdown::analysis
