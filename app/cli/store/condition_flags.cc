#include "app/cli/store/condition_flags.h"

#include <fmt/format.h>

#include <stdexcept>

#include "app/cli/options.h"
#include "app/trials/statement.h"
#include "app/trials/typed_values.h"
#include "touchdown/db/register.h"

namespace touchdown::cli {
namespace {

// Returns the expected form of --condition with all its keys, for help and
// messages.
std::string Form() {
  std::string form = "KEY=VALUE with one of the keys";
  std::string_view before = " ";
  for (const std::string& key : pipeline::ConditionKeys()) {
    form += fmt::format("{}{}", before, key);
    before = ", ";
  }
  return form;
}

}  // namespace

// Each use takes one value. Without OneAtATime() the flag would swallow the
// positional arguments behind it.
void AddConditionFlag(CLI::App& command, ConditionFlags& flags) {
  AddOption(command, "--condition", flags,
            "of the shot, " + Form() + "; may be given several times")
      .NameType("KEY=VALUE")
      .OneAtATime();
}

void ApplyCondition(const std::string& text, core::Conditions& conditions) {
  // Only the first '=' is a separator: a value may hold others.
  const std::size_t sign = text.find('=');
  const std::string key = text.substr(0, sign);
  try {
    if (sign != std::string::npos &&
        pipeline::SetCondition(key, text.substr(sign + 1), conditions)) {
      return;
    }
  } catch (const pipeline::FieldError& mistake) {
    // The error names the key; here it is said that it came with --condition.
    throw std::invalid_argument(
        fmt::format("--condition {} {}", mistake.field(), mistake.problem()));
  }
  throw std::invalid_argument(
      fmt::format("--condition is '{}', must be {}", text, Form()));
}

void ApplyConditions(const ConditionFlags& flags,
                     std::optional<core::Conditions>& conditions) {
  if (flags.empty()) return;
  // "None were stated" and "nothing is known" differ in the store, so the
  // conditions come into being only where one is given.
  if (!conditions) conditions.emplace();
  for (const std::string& flag : flags) ApplyCondition(flag, *conditions);
}

std::optional<core::Conditions> ReadConditions(
    const ConditionFlags& flags, const std::filesystem::path& db) {
  std::optional<core::Conditions> conditions;
  ApplyConditions(flags, conditions);
  // Conditions without names (temperature, a note) need no store to be there.
  if (conditions && db::NameEntries(*conditions)) {
    conditions =
        db::Resolved(db::Store::Open(db, db::OpenMode::kRead), *conditions);
  }
  return conditions;
}

}  // namespace touchdown::cli
