// Slide or bounce: the one rule.
//
//   bounce     the 95 % interval of the greatest gap between release and the
//   end
//              of what was filmed lies above the bounce height
//   not        it lies below
//   undecided  neither; or the rebound was not filmed
#pragma once

#include <optional>
#include <span>
#include <string>

#include "touchdown/core/estimate.h"
#include "touchdown/core/trial.h"
#include "touchdown/vision/plane_track.h"

namespace touchdown::vision {

// The greatest gap over `samples` (all after touchdown, by time), in px above
// `ground_px`: of parabolas fitted to a few neighbouring frames, which do not
// reach across the `breaks` (indices of samples that start a new flight).
// Absent where no frame was filmed. The uncertainty holds pose noise; that of
// the ground is the caller's to add.
struct GreatestGap {
  core::Estimate gap_px;
  std::size_t at = 0;         // index of the sample
  bool still_rising = false;  // at the last frame: a greater one may follow
};
std::optional<GreatestGap> FindGreatestGap(std::span<const PlaneSample> samples,
                                           std::span<const std::size_t> breaks,
                                           double ground_px);

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
  core::MotionState label =
      core::MotionState::kUndecided;  // kBounce,
                                      // kStaysDown or kUndecided
  double p_bounce = 0.5;
};
StateEvidence DecideBounce(const core::Estimate& gap, double height);

}  // namespace touchdown::vision
