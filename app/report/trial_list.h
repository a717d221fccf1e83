// One line of a list of trials, as JSON: an entry of touchdown.list/1, and of
// the review page's list.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "touchdown/core/trial.h"

namespace touchdown::report {

// Degrees and millimetres; what is absent is null. The document is not in it.
nlohmann::ordered_json TrialRowJson(const core::Trial& trial);

}  // namespace touchdown::report
