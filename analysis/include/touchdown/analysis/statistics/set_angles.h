// Trials whose set angle repeats: what was set says where the body came down,
// beside what was measured.
//
// Where many trials share a set angle, the measured angles scatter about it for
// two reasons: the ejector's repeatability t moved the body, and the error u
// of the measurement did not. To take each measured angle at its word (the
// classical error) then puts the boundary too far from the set angle, by the
// factor (t^2 + u^2) / t^2. The remedy is Berkson's: of n trials at one set
// angle, of mean x_mean,
//   k = t^2 / (t^2 + u^2)
//   x' = x_mean + k (x - x_mean)
//   u'^2 = k u^2 + (1 - k)^2 (t^2 + u^2) / n
// (statistics.md section 1.2, with the ejector's own offset, unknown, taken
// from the mean). One trial alone keeps its angle and its u.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "touchdown/analysis/statistics/observation.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {

struct SetAngleOptions {
  // The ejector's repeatability as it is believed before the trials, and how
  // many trials that belief is worth beside what their scatter says: few enough
  // that ten repeats speak for themselves.
  double set_u_rad = 0.5 * core::kDegree;
  double worth_trials = 4.0;
};

struct SetAngleUse {
  std::vector<Observation> observations;  // in the order given
  int repeated = 0;  // trials that were drawn towards the mean of their set
  // The repeatability that was used; absent where nothing repeats.
  std::optional<double> set_u_rad;
};

// Set angles are equal where they differ by less than kSameAngle_rad; set-ups
// are apart. Trials at one set angle whose measured angles are all the same
// were typed and not measured: they stay as they are. Throws
// std::invalid_argument naming the option that is out of its range.
SetAngleUse UseSetAngles(std::span<const Observation> observations,
                         const SetAngleOptions& options = {});

}  // namespace touchdown::analysis
