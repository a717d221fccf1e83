// The lab's register as JSON, one line for each version of an entry, in the
// manner of trial_json.h: nothing is lost on the way there and back.
#pragma once

#include <string>
#include <string_view>

#include "app/text/json_fields.h"
#include "touchdown/db/register.h"

namespace touchdown::report {

inline constexpr std::string_view kEntrySchema = "touchdown.register/1";

std::string EntryJson(const db::Entry& entry);
// The inverse. Throws std::invalid_argument naming the field that is missing
// or wrong.
db::Entry EntryFromJson(std::string_view line);

// The conditions of a trial: part of its line.
Json ConditionsJson(const core::Conditions& conditions);
core::Conditions ReadConditions(const Json& json);

}  // namespace touchdown::report
