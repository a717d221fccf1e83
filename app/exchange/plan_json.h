// Plans of campaigns and looks at their answers as JSON, one line each, in the
// manner of trial_json.h.
#pragma once

#include <string>
#include <string_view>

#include "touchdown/db/plan.h"

namespace touchdown::report {

inline constexpr std::string_view kPlanSchema = "touchdown.plan/1";

std::string PlanEventJson(const db::PlanEvent& event);
// The inverse. Throws std::invalid_argument naming the field that is missing
// or wrong.
db::PlanEvent PlanEventFromJson(std::string_view line);

}  // namespace touchdown::report
