// A check of single trials, pooled over the trials of one set-up: what nature
// or a statement fixes (gravity, the body's size) over what was measured of it.
// Twenty trials that are 3 % off in one direction are sure where one is not.
//
//   r = sum w_i r_i / sum w_i,  w_i = 1 / u_i^2,  u_own^2 = b / sum w_i
//   b = max(1, chi^2 / (n - 1))         (Birge: scatter beyond the u_i widens)
//   u^2 = u_own^2 + u_common^2          (what all trials share: scale, site)
//   z = (r - 1) / u
#pragma once

#include <span>

#include "touchdown/core/estimate.h"
#include "touchdown/core/expected.h"

namespace touchdown::analysis {

struct PoolOptions {
  // |z| beyond which a check has failed. 3.3: one in 1000 of normal errors, so
  // that three checks flag less than 1 % of right campaigns. Smaller finds
  // smaller mistakes and blames more set-ups wrongly. Chosen by `./dev bench
  // campaign_checks`.
  double most_z = 3.3;
  // Fewer trials are not pooled: their scatter says too little of their u.
  int least_trials = 5;
};

struct PooledCheck {
  int trials = 0;
  core::Estimate ratio;  // measured over expected; u with what is common
  double z = 0.0;
  bool failed = false;
  // The relative error that 95 of 100 such campaigns would fail for: (most_z +
  // 1.645) u, with u_own a little wider, as its scatter may make it. What is
  // smaller these trials cannot show.
  double shows = 0.0;
};

// `ratios`: measured over expected of each trial with its own u; `common_u`
// relative, of all of them together. Absent with the reason where there are too
// few. Throws std::invalid_argument for a u that is not positive or a common u
// below 0.
core::Expected<PooledCheck> PoolChecks(std::span<const core::Estimate> ratios,
                                       double common_u,
                                       const PoolOptions& options = {});

}  // namespace touchdown::analysis
