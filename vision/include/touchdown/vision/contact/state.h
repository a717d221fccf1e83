// Slide or bounce: the one rule.
//
//   bounce     the 95 % interval of the greatest gap, between release and the
//              end of what was filmed, lies above the bounce height
//   not        it lies below
//   undecided  neither; or the rebound was not filmed
#pragma once

#include <string>

#include "touchdown/core/estimate.h"
#include "touchdown/core/trial.h"

namespace touchdown::vision {

// Smallest bounce that a recording can show (power and level 0.95), in metres:
// the larger of the matched filter's
//   h^(5/4) = 3.29 s / sqrt((16/15) f sqrt(2/g))
// (s: gap noise of a frame in m, f: frames per second) and three frames of
// flight, h = (g/8) (3/f)^2; with the ground's own uncertainty u_ground_m
// (one-sided 95 %) added in quadrature.
double DetectableGap(double gap_noise_m, double frames_per_s, double u_ground_m,
                     double gravity_mps2);

// Applies the rule. `gap` and `height` in the same unit.
struct StateEvidence {
  // kBounce, kStaysDown or kUndecided.
  core::MotionState label = core::MotionState::kUndecided;
  double p_bounce = 0.5;
};
StateEvidence DecideBounce(const core::Estimate& gap, double height);

}  // namespace touchdown::vision
