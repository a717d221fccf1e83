// One line of a list of trials, as JSON: an entry of touchdown.list/1, and of
// the review page's list.
#pragma once

#include "app/text/json.h"
#include "touchdown/core/trial.h"

namespace touchdown::report {

// Degrees and millimetres; what is absent is null. The document is not in it.
Json TrialRowJson(const core::Trial& trial);

}  // namespace touchdown::report
