// Which part of an angle's uncertainty the trials of a set-up share: from the
// budgets and calibrations that the store keeps of each trial.
#pragma once

#include <span>
#include <vector>

#include "touchdown/analysis/statistics/observation.h"
#include "touchdown/core/trial.h"

namespace touchdown::report {

// Splits the u of each observation into its own and the common part, and tells
// which set-up it belongs to. Common are the lines of the angle's budget that
// the set-up brings with it: level, lens, yaw, scale, whatever a CSV file calls
// `common`; and `ground` where the ground line is the calibration's or a
// person's, not found in each clip anew. A set-up is a calibration: trials that
// name none are one set-up together. `observations[i].trial` is an index into
// `trials`.
void ShareErrors(std::span<const core::Trial> trials,
                 std::vector<analysis::Observation>& observations);

}  // namespace touchdown::report
