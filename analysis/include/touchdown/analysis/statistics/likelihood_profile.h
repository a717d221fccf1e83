// The boundary angle from trials without a prior: the profile of the
// likelihood.
//
// pl(theta) = max over s of l(theta, s), l as in boundary_fit.h without lapses.
// Interval: all theta with 2 (max pl - pl(theta)) <= 3.841, the 0.95 quantile
// of chi^2 with one degree of freedom. A cross-check of the posterior: it
// exists for separated data too, but may be open, and few trials make it too
// narrow.
#pragma once

#include <numbers>
#include <span>

#include "touchdown/analysis/statistics/boundary_fit.h"
#include "touchdown/analysis/statistics/observation.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {

struct ProfileOptions {
  double low_rad = 0.0;  // theta is looked for between low and high
  double high_rad = std::numbers::pi / 2;
  double scatter_low_rad = 0.05 * core::kDegree;
  double scatter_high_rad = 40.0 * core::kDegree;
};

struct LikelihoodProfile {
  DataStatus status = DataStatus::kNoTrials;
  // Where pl is greatest; the middle of the flat top where the data are
  // separated and s cannot be told from 0.
  double estimate_rad = 0.0;
  double scatter_rad = 0.0;  // at the estimate; 0 where separated
  // False where the likelihood has no greatest value inside the ranges: one
  // outcome only, or reversed (then it grows as s grows without end).
  bool has_estimate = false;
  core::Interval interval95_rad;  // ends at low_rad or high_rad where open
  bool open_low = true;
  bool open_high = true;
};

// Throws std::invalid_argument naming the option that is out of its range.
LikelihoodProfile ProfileLikelihood(std::span<const Observation> observations,
                                    const ProfileOptions& options = {});

// The same from the grid of a posterior: for trials that share errors, which
// ProfileLikelihood() does not look at. The maximum over s is taken on the
// grid's levels; limits are right to a hundredth of the posterior's sd.
LikelihoodProfile ProfileOfPosterior(const BoundaryPosterior& posterior);

}  // namespace touchdown::analysis
