// Published rules for the next level, beside the one of next_angle.h: to be
// compared with, and for those who must follow a standard.
#pragma once

#include <numbers>
#include <optional>
#include <span>

#include "touchdown/analysis/statistics/next_angle.h"
#include "touchdown/analysis/statistics/observation.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {

// What the operator believes before the first trial.
struct DesignGuess {
  double guess_low_rad = 0.0;   // the boundary lies between these two
  double guess_high_rad = 0.0;  //
  double guess_scatter_rad = 0.0;
  core::Interval feasible_rad{0.0, std::numbers::pi / 2};
};

// Neyer's D-optimal test (Technometrics 36, 61-70, 1994; MIL-STD-331): the next
// level after `trials`, in the order in which they were thrown; undecided ones
// are passed over. The published example of 20 levels comes out exactly. Throws
// std::invalid_argument unless low < high and scatter > 0.
NextAngle NextNeyer(std::span<const Observation> trials,
                    const DesignGuess& options);

// Wu and Tian's three-phase optimal design, 3pod (Journal of Statistical
// Planning and Inference 149, 1-15, 2014): the same beliefs and more robust
// against wrong ones. Phase I searches (quarters of the range, bisection,
// probes at 0.3 of the guessed scatter beside the bracket until outcomes
// overlap), phase II is D-optimal.
//
// The next level after `trials`, in the order in which they were thrown;
// undecided ones are passed over. The published example of 15 levels comes out
// to its two decimals. Throws like NextNeyer.
NextAngle NextThreePhase(std::span<const Observation> trials,
                         const DesignGuess& options);

// Up and down (Dixon and Mood 1948), for an operator without a computer: one
// step down after a bounce, one step up after a slide, the same again after an
// undecided trial.
struct UpDownOptions {
  double start_rad = 20.0 * core::kDegree;
  double step_rad = 1.0 * core::kDegree;  // half to one and a half scatters
  core::Interval feasible_rad{0.0, std::numbers::pi / 2};
};
NextAngle NextUpDown(std::span<const Observation> trials,
                     const UpDownOptions& options = {});

}  // namespace touchdown::analysis
