#include "touchdown/analysis/statistics/evidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "touchdown/analysis/statistics/likelihood_profile.h"
#include "touchdown/analysis/statistics/special_functions.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {
namespace {

using core::kDegree;

std::vector<Observation> Trials(int n, double scatter_deg, double u_deg,
                                std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(5.0, 20.0);
  std::vector<Observation> out;
  for (int i = 0; i < n; ++i) {
    const double x = uniform(engine);
    const bool bounced = x > 12.0 + scatter_deg * normal(engine);
    out.push_back(Observe((x + u_deg * normal(engine)) * kDegree,
                          u_deg * kDegree, bounced));
  }
  return out;
}

// The ends of the profile's 95 % interval are where twice the log ratio is
// 3.841: an oracle that shares no grid with the table.
TEST(WeighEvidence, AgreesWithTheExactProfile) {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const auto trials = Trials(12 + 6 * static_cast<int>(seed),
                               seed % 3 == 0 ? 2.0 : 0.8, 0.3, seed);
    const auto profile = ProfileLikelihood(trials);
    if (profile.open_low || profile.open_high) continue;
    const core::Interval& i = profile.interval95_rad;
    for (const auto& [levels, tolerance] :
         {std::pair{30, 0.05}, std::pair{16, 0.15}}) {
      EvidenceOptions options;
      options.scatter_levels = levels;
      const Evidence e = WeighEvidence(trials, {"t", (i.low + i.high) / 2},
                                       (i.high - i.low) / 2, options);
      EXPECT_NEAR(e.log_below, -3.841459 / 2, tolerance) << seed;
      EXPECT_NEAR(e.log_above, -3.841459 / 2, tolerance) << seed;
      EXPECT_EQ(e.log_within, 0.0) << seed;
    }
    ++compared;
  }
  EXPECT_GE(compared, 8);
}

TEST(WeighEvidence, AddingOneByOneIsAddingAll) {
  const auto trials = Trials(25, 1.0, 0.3, 3);
  const TheoryBoundary theory{"t", 11.0 * kDegree};
  EvidenceTable table(theory, kDegree);
  for (const Observation& o : trials) table.Add({&o, 1});
  const Evidence one_by_one = table.Weigh();
  const Evidence at_once = WeighEvidence(trials, theory, kDegree);
  EXPECT_NEAR(one_by_one.log_below, at_once.log_below, 1e-9);
  EXPECT_NEAR(one_by_one.log_above, at_once.log_above, 1e-9);
  EXPECT_NEAR(one_by_one.log_within, at_once.log_within, 1e-9);
  // And taken out again.
  const auto others = Trials(7, 1.0, 0.2, 4);
  table.Add(others);
  table.Remove(others);
  EXPECT_NEAR(table.Weigh().log_below, at_once.log_below, 1e-9);
}

// n slides at one angle: a boundary at or below it can do no better than
// (1/2)^n whatever the scatter; one above explains them all.
TEST(WeighEvidence, EveryScatterIsAllowed) {
  std::vector<Observation> slides;
  for (int n = 1; n <= 40; ++n) {
    slides.push_back(Observe(20.0 * kDegree, 0.1 * kDegree, 0.0));
    const Evidence e = WeighEvidence(slides, {"t", 19.0 * kDegree}, kDegree);
    EXPECT_NEAR(e.log_below - e.log_above, n * LogNormalCdf(-2.0 / 40.5),
                0.002 * n)
        << n;
    EXPECT_NEAR(e.log_within, n * std::log(0.5), 1e-6 * n) << n;
  }
}

// The theory's U widens the range that a contradiction must exclude.
TEST(WeighEvidence, TheUOfTheTheoryWidensTheFarRange) {
  const auto trials = Trials(40, 0.5, 0.2, 5);
  const TheoryBoundary exact{"t", 9.0 * kDegree};
  const TheoryBoundary vague{"t", 9.0 * kDegree, 0.75 * kDegree};
  const Evidence e = WeighEvidence(trials, exact, kDegree);
  const Evidence v = WeighEvidence(trials, vague, kDegree);
  EXPECT_NEAR(e.log_near, e.log_within, 1e-12);
  EXPECT_GT(v.log_near, e.log_near + 1.0);
  EXPECT_NEAR(v.log_within, e.log_within, 0.05);
}

// A common error by brute force: the likelihood averaged over it.
TEST(EvidenceTable, IntegratesTheErrorThatASetUpShares) {
  const double common_deg = 0.5;
  auto trials = Trials(30, 0.6, 0.3, 8);
  for (std::size_t i = 0; i < trials.size(); ++i) {
    trials[i].common_u_rad = common_deg * kDegree;
    trials[i].setup = i % 2 == 0 ? 1 : 2;
  }
  const auto log_likelihood = [&](int setup, double theta_deg, double s_deg) {
    double sum = 0.0;
    for (const Observation& o : trials) {
      if (o.setup != setup) continue;
      const double z = (o.angle_rad / kDegree - theta_deg) /
                       std::hypot(s_deg, o.u_rad / kDegree);
      sum += LogNormalCdf(o.p_bounce == 1.0 ? z : -z);
    }
    return sum;
  };
  const auto averaged = [&](int setup, double theta_deg, double s_deg) {
    double sum = 0.0;
    double weights = 0.0;
    for (double z = -5.0; z <= 5.0; z += 0.02) {
      const double w = std::exp(-z * z / 2);
      weights += w;
      sum += w *
             std::exp(log_likelihood(setup, theta_deg + common_deg * z, s_deg));
    }
    return std::log(sum / weights);
  };
  const auto greatest = [&](double low_deg, double high_deg) {
    double best = -std::numeric_limits<double>::infinity();
    for (double theta = low_deg; theta <= high_deg + 1e-9; theta += 0.05) {
      for (double log_s = std::log(0.05); log_s < std::log(5.0); log_s += 0.1) {
        const double s = std::exp(log_s);
        best = std::max(best, averaged(1, theta, s) + averaged(2, theta, s));
      }
    }
    return best;
  };
  const Evidence e = WeighEvidence(trials, {"t", 12.0 * kDegree}, kDegree);
  const double within = greatest(11.0, 13.0);
  EXPECT_NEAR(e.log_below - e.log_within, greatest(8.0, 11.0) - within, 0.03);
  EXPECT_NEAR(e.log_above - e.log_within, greatest(13.0, 16.0) - within, 0.03);
}

TEST(EvidenceTable, ItsPosteriorIsTheFitsPosterior) {
  const auto trials = Trials(30, 0.8, 0.3, 11);
  EvidenceTable table({"t", 12.0 * kDegree}, kDegree);
  table.Add(trials);
  const BoundaryGrid grid = table.Posterior();
  const BoundaryPosterior fit = FitBoundary(trials);
  double mean = 0.0;
  for (std::size_t k = 0; k < grid.weight.size(); ++k) {
    mean += grid.weight[k] * grid.angle_rad[k / grid.scatter_rad.size()];
  }
  EXPECT_NEAR(mean, fit.mean_rad, 0.02 * fit.sd_rad);
}

TEST(EvidenceTable, RefusesWhatCannotBe) {
  EXPECT_THROW(EvidenceTable({"t", 0.2}, 0.0), std::invalid_argument);
  EXPECT_THROW(EvidenceTable({"t", 0.2, -1.0}, 0.1), std::invalid_argument);
  EvidenceOptions options;
  options.low_rad = 2.0;
  EXPECT_THROW(EvidenceTable({"t", 0.2}, 0.1, options), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::analysis
