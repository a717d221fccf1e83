// The document of a trial's analysis as some version of the program once wrote
// it: nothing in it is relied on.
#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>

#include "touchdown/core/trial.h"

namespace touchdown::report {

// Null where the trial has none, or one that is no document.
nlohmann::json StoredDocument(const core::Trial& trial);

// The value at the end of these names; null where there is none.
const nlohmann::json& FindValue(const nlohmann::json& document,
                                std::initializer_list<const char*> path);

}  // namespace touchdown::report
