// At which angle to throw next, and when to stop.
#pragma once

#include <cstdint>
#include <numbers>
#include <optional>
#include <random>
#include <span>

#include "touchdown/analysis/statistics/boundary_fit.h"
#include "touchdown/analysis/statistics/observation.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {

struct NextAngleOptions {
  // What the rig can throw. The caller computes it; an angle outside is moved
  // to the nearer end and says so.
  core::Interval feasible_rad{0.0, std::numbers::pi / 2};
  // Repeatability of the ejector: the body will not touch down at exactly the
  // angle that was set.
  double set_u_rad = 0.5 * core::kDegree;
  double candidate_step_rad = 0.5 * core::kDegree;
  // Successive angles are spread over +- this much, evenly and reproducibly, so
  // that trials do not sit on two levels. 0: no spread.
  double spread_rad = 0.25 * core::kDegree;
  // The angle is chosen as if the scatter had this prior, whatever the estimate
  // was made with: a prior with the long tail that honest intervals need makes
  // the rule spend its first trials on that tail. Simulated (scatter 0.3 deg),
  // the estimate is within 0.5 deg in 95 of 100 cases after 14 trials instead
  // of 18.
  ScatterPrior design_scatter{0.7 * core::kDegree, 1.0};
  // Enough when the 95 % interval is no wider than +- this.
  double target_half_width_rad = 0.5 * core::kDegree;
  int max_trials = 60;  // or when so many have been thrown
  // Of ForecastTrials(): its futures (0: no forecast) and their seed.
  int forecast_futures = 15;
  std::uint64_t forecast_seed = 1;
};

enum class StopReason { kNone, kTargetReached, kMaxTrials };

struct NextAngle {
  double angle_rad = 0.0;
  bool clipped = false;  // the rule asked for an angle the rig cannot throw
  // Standard deviation of the boundary to expect after that trial.
  double expected_sd_rad = 0.0;
  double half_width_rad = 0.0;  // of the 95 % interval now
  StopReason stop = StopReason::kNone;
  int trials_to_target = 0;  // ForecastTrials() for the target half-width
};

// The primary rule: the candidate with the least expected variance of the
// boundary angle after one more trial, p v1 + (1 - p) v0 (one step ahead, ties
// to the lower angle). `trials_so_far` counts all trials, decided or not.
// Throws std::invalid_argument naming the option that is out of its range.
NextAngle ChooseNextAngle(const BoundaryPosterior& posterior, int trials_so_far,
                          const NextAngleOptions& options = {});

// Standard deviation of the boundary to expect after a trial at `angle`.
double ExpectedSd(const BoundaryPosterior& posterior, double angle_rad,
                  const NextAngleOptions& options = {});

struct ForecastOptions {
  double target_half_width_rad = 0.5 * core::kDegree;
  double set_u_rad = 0.5 * core::kDegree;  // repeatability of the ejector
  // The answer is their median: repeatable to about a third of how far futures
  // differ, and 10 ms.
  int futures = 15;
  // Futures are drawn as if the scatter had this prior; the estimate inside
  // each keeps its own. With the estimate's own long tail the forecast for a
  // sharp boundary is three times too large.
  ScatterPrior design_scatter{0.7 * core::kDegree, 1.0};
};

// Forecast: how many further trials until the 95 % interval is no wider than
// +- target. The rule is played forward on a coarse grid from boundaries and
// scatters drawn from the posterior, with trials as uncertain as those so far;
// the median of the futures. Throws std::invalid_argument naming the option
// that is out of its range.
int ForecastTrials(const BoundaryPosterior& posterior,
                   const ForecastOptions& options, std::mt19937_64& engine);

}  // namespace touchdown::analysis
