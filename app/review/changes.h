// What differs between the revisions of a trial, for a person.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "touchdown/core/trial.h"
#include "touchdown/db/records.h"

namespace touchdown::review {

// What differs (db::Changes): in words, degrees and millimetres, rounded to
// what is known. [{"field": "approach_angle_deg", "words": "approach angle,
// deg", "from", "to"}]. That a document was made anew is told where nothing
// else is.
nlohmann::ordered_json ChangesJson(const core::Trial& before,
                                   const core::Trial& after);

// Who changed what, when and why; the oldest first.
nlohmann::ordered_json HistoryJson(const std::vector<db::Revision>& history);

}  // namespace touchdown::review
