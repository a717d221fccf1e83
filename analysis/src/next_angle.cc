#include "touchdown/analysis/next_angle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "design.h"
#include "feasible.h"
#include "likelihood.h"
#include "touchdown/analysis/agreement.h"
#include "touchdown/analysis/special_functions.h"

namespace touchdown::analysis {
namespace {

// Candidates lie within this many standard deviations of the mean, and at least
// this far on either side.
constexpr double kReach_sd = 4.0;
constexpr double kLeastReach_rad = 3.0 * core::kDegree;
// Grid points with less weight than this are passed over: together they hold
// less than a ten-thousandth of the posterior.
constexpr double kNegligibleWeight = 1e-9;

// Expected variance of theta after one trial at `angle`.
double ExpectedVariance(const BoundaryGrid& grid, double angle_rad,
                        const std::vector<double>& inverse_scatter, double mean,
                        double second) {
  const std::size_t m = grid.scatter_rad.size();
  double p = 0.0;
  double p_theta = 0.0;
  for (std::size_t i = 0; i < grid.angle_rad.size(); ++i) {
    const double theta = grid.angle_rad[i];
    double q = 0.0;
    for (std::size_t j = 0; j < m; ++j) {
      const double w = grid.weight[i * m + j];
      if (w < kNegligibleWeight) continue;
      q += w * FastNormalCdf((angle_rad - theta) * inverse_scatter[j]);
    }
    p += q;
    p_theta += q * (theta - mean);
  }
  // p v1 + (1 - p) v0, each v being E[theta^2] - E[theta]^2 given the outcome.
  double expected = second;
  if (p > 0.0) expected -= p_theta * p_theta / p;
  if (p < 1.0) expected -= p_theta * p_theta / (1.0 - p);
  return expected;
}

// The golden ratio's multiples fill an interval evenly, however many there are.
double Spread(int trial, double spread_rad) {
  const double turn = trial * (std::numbers::phi - 1.0);
  return spread_rad * (2.0 * (turn - std::floor(turn)) - 1.0);
}

double HalfWidth(const BoundaryPosterior& posterior) {
  return (posterior.interval95_rad.high - posterior.interval95_rad.low) / 2;
}

}  // namespace

double ExpectedSd(const BoundaryPosterior& posterior, double angle_rad,
                  const NextAngleOptions& options) {
  std::vector<double> inverse_scatter;
  for (const double s : posterior.grid.scatter_rad) {
    inverse_scatter.push_back(1.0 / std::hypot(s, options.set_u_rad));
  }
  return std::sqrt(std::max(
      ExpectedVariance(posterior.grid, angle_rad, inverse_scatter,
                       posterior.mean_rad, posterior.sd_rad * posterior.sd_rad),
      0.0));
}

NextAngle ChooseNextAngle(const BoundaryPosterior& posterior, int trials_so_far,
                          const NextAngleOptions& options) {
  CheckFeasible(options.feasible_rad);
  Require(options.set_u_rad >= 0.0, "set_u_rad", options.set_u_rad,
          "not negative");
  Require(options.candidate_step_rad > 1e-5, "candidate_step_rad",
          options.candidate_step_rad, "above 0.00001 rad");
  Require(options.spread_rad >= 0.0, "spread_rad", options.spread_rad,
          "not negative");
  Require(options.target_half_width_rad > 0.0, "target_half_width_rad",
          options.target_half_width_rad, "positive");

  Require(options.design_scatter.median_rad > 0.0, "design_scatter median_rad",
          options.design_scatter.median_rad, "positive");
  if (const auto& log_sd = options.design_scatter.log_sd) {
    Require(*log_sd > 0.0, "design_scatter log_sd", *log_sd, "positive");
  }

  const Design design = Reweigh(posterior, options.design_scatter);
  std::vector<double> inverse_scatter;
  for (const double s : design.grid.scatter_rad) {
    inverse_scatter.push_back(1.0 / std::hypot(s, options.set_u_rad));
  }
  const double mean = design.mean_rad;
  const double reach = std::max(kReach_sd * design.sd_rad, kLeastReach_rad);
  const double step = options.candidate_step_rad;
  const double variance = design.sd_rad * design.sd_rad;
  // Where the rig cannot reach what is believed, the nearer of its ends is all
  // that can be thrown: Clipped() sees to that.
  double best = mean;
  double best_variance = std::numeric_limits<double>::infinity();
  // The same without the rig's limits, which tells whether they matter.
  double wanted = mean;
  double wanted_variance = best_variance;
  const auto last = std::llround(std::floor((mean + reach) / step));
  for (auto i = std::llround(std::ceil((mean - reach) / step)); i <= last;
       ++i) {
    const double c = static_cast<double>(i) * step;
    const bool feasible =
        c >= options.feasible_rad.low && c <= options.feasible_rad.high;
    if (!feasible && (c < 0.0 || c > std::numbers::pi / 2)) continue;
    const double expected =
        ExpectedVariance(design.grid, c, inverse_scatter, mean, variance);
    if (expected < wanted_variance * (1.0 - 1e-12)) {
      wanted_variance = expected;
      wanted = c;
    }
    if (!feasible) continue;
    // A tie, to rounding, stays with the lower angle.
    if (expected < best_variance * (1.0 - 1e-12)) {
      best_variance = expected;
      best = c;
    }
  }
  NextAngle out = Clipped(best + Spread(trials_so_far, options.spread_rad),
                          options.feasible_rad);
  // Not because of the spread alone.
  out.clipped =
      wanted < options.feasible_rad.low || wanted > options.feasible_rad.high;
  out.expected_sd_rad = ExpectedSd(posterior, out.angle_rad, options);
  out.half_width_rad = HalfWidth(posterior);
  if (out.half_width_rad <= options.target_half_width_rad) {
    out.stop = StopReason::kTargetReached;
  } else if (trials_so_far >= options.max_trials) {
    out.stop = StopReason::kMaxTrials;
  }
  if (options.forecast_futures > 0) {
    std::mt19937_64 engine(options.forecast_seed);
    out.trials_to_target =
        ForecastTrials(posterior,
                       {options.target_half_width_rad, options.set_u_rad,
                        options.forecast_futures, options.design_scatter},
                       engine);
  }
  return out;
}

}  // namespace touchdown::analysis
