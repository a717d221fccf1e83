// --condition KEY=VALUE: under what conditions a shot was made.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "touchdown/core/conditions.h"

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace touchdown::cli {

// One text for each time the flag is given: "spring=S 3", "temperature_c=21.5
// +-0.5", "anomaly=light".
using ConditionFlags = std::vector<std::string>;
void AddConditionFlag(CLI::App& command, ConditionFlags& flags);

// "KEY=VALUE" into `conditions`; the rest stays as it is. Throws
// std::invalid_argument.
void ApplyCondition(const std::string& text, core::Conditions& conditions);

// Puts what was given into `conditions`; the rest stays as it is. Throws
// std::invalid_argument naming what was given and what is expected.
void ApplyConditions(const ConditionFlags& flags,
                     std::optional<core::Conditions>& conditions);

// Nothing where none were given. Entries of the register are looked up in the
// store at `db` at once, before a long analysis.
std::optional<core::Conditions> ReadConditions(const ConditionFlags& flags,
                                               const std::filesystem::path& db);

}  // namespace touchdown::cli
