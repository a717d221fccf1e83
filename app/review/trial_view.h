// One trial as the page shows it: numbers, and what to draw on the pictures.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "app/measure/analyze.h"
#include "touchdown/core/trial.h"

namespace touchdown::review {

// What is drawn and plotted of an analysis, in px of the recorded picture:
// ground line, outlines, flights, point of contact; gap over time and residuals
// of the flights, in mm where there is a scale; the bounce height; the checks
// of the answer (measure/answer_check.h).
nlohmann::ordered_json ViewJson(const pipeline::Analysis& analysis);

// The measured numbers of a trial in words; budgets; state. What is absent says
// why.
nlohmann::ordered_json NumbersJson(const core::Trial& trial);

}  // namespace touchdown::review
