// What a trial's touchdown.analysis document says of how it was measured.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "touchdown/core/trial.h"

namespace touchdown::report {

using NameValue = std::pair<std::string, std::string>;

// Recording, time base, scale, calibration, ground line, what the model of the
// scene used and left out, warnings: in this order, each in words. Empty where
// the trial has no document or a damaged one. Names of equal facts are equal
// over trials.
std::vector<NameValue> AnalysisFacts(const core::Trial& trial);

// The four that a report counts over trials: "scale from", "ground line from",
// "calibration", "time base".
std::vector<NameValue> AnalysisSources(const core::Trial& trial);

// The budget of the angle that the trial's protocol names.
const core::Budget& AngleBudget(const core::Trial& trial);

}  // namespace touchdown::report
