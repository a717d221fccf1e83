// What every rule for the next angle does with its options and its answer.
#pragma once

#include <algorithm>
#include <cmath>

#include "touchdown/analysis/statistics/next_angle.h"
#include "touchdown/core/require.h"

namespace touchdown::analysis {

inline void CheckFeasible(const core::Interval& feasible) {
  core::Require(std::isfinite(feasible.low), "feasible_rad.low", feasible.low,
                "finite");
  core::Require(feasible.high >= feasible.low && std::isfinite(feasible.high),
                "feasible_rad.high", feasible.high,
                "finite and not below feasible_rad.low");
}

inline NextAngle Clipped(double angle_rad, const core::Interval& feasible) {
  NextAngle out;
  out.angle_rad = std::clamp(angle_rad, feasible.low, feasible.high);
  out.clipped = out.angle_rad != angle_rad;
  return out;
}

}  // namespace touchdown::analysis
