// One trial as the page shows it: numbers, history, and what to draw on the
// pictures.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/pipeline/analyze.h"
#include "touchdown/core/trial.h"
#include "touchdown/db/records.h"

namespace touchdown::review {

// What is drawn and plotted of an analysis, in px of the recorded picture:
// ground line, outlines, flights, point of contact; gap over time and residuals
// of the flights, in mm where there is a scale.
nlohmann::ordered_json ViewJson(const pipeline::Analysis& analysis);

// The measured numbers of a trial in words, in the order of the store's
// columns; budgets; state. What is absent says why.
nlohmann::ordered_json NumbersJson(const core::Trial& trial);

// Who changed what, when and why; the oldest first.
nlohmann::ordered_json HistoryJson(const std::vector<db::Revision>& history);

// What differs (db::Changes), for a person: degrees and millimetres, rounded to
// what is known.
nlohmann::ordered_json ChangesJson(const core::Trial& before,
                                   const core::Trial& after);

}  // namespace touchdown::review
