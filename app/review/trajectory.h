// Where the body of a trial was, as a file for other programs.
#pragma once

#include <string>

#include "touchdown/core/expected.h"
#include "touchdown/core/trial.h"

namespace touchdown::review {

// CSV, a line for each frame: frame, time_s, x_mm, y_mm, gap_mm,
// face_angle_deg in the plane frame (x along the ground in the direction of
// travel, y up), as the trial's document has them under "path". An absent
// number is an empty cell. Absent, with the reason, where there is no document
// or no scale.
core::Expected<std::string> TrajectoryCsv(const core::Trial& trial);

}  // namespace touchdown::review
