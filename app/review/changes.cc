#include "app/review/changes.h"

#include <fmt/format.h>

#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "app/review/words.h"
#include "app/text/format.h"
#include "app/text/json.h"
#include "touchdown/core/quantities.h"
#include "touchdown/core/units.h"
#include "touchdown/db/register.h"

namespace touchdown::review {
namespace {

using report::Json;

// db::Changes puts these prefixes before the column.
constexpr std::string_view kOfConditions = "conditions: ";
constexpr std::string_view kContactPrefix = "contact ";  // "contact 2: "

// "contact 2: state": which part of a trial, and its column.
struct Field {
  std::string_view prefix;
  std::string_view column;
};

// Divides "contact 2: state" behind ": "; the prefix is empty for the trial
// itself and its first contact.
Field SplitField(std::string_view change) {
  const std::size_t colon = change.find(": ");
  if (colon == std::string_view::npos) return {"", change};
  return {change.substr(0, colon + 2), change.substr(colon + 2)};
}

// Returns the contact that a field is of.
// Null where the trial has no such contact, or the field is of no contact.
const core::ContactRecord* FindContactRecord(const core::Trial& trial,
                                             const Field& field) {
  if (field.prefix.empty()) return &trial.first;
  if (!field.prefix.starts_with(kContactPrefix)) return nullptr;
  const std::string_view digits = field.prefix.substr(kContactPrefix.size());
  std::size_t number = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), number);
  // The first contact has no number; the second is the first of `later`.
  if (number < 2 || number - 2 >= trial.later.size()) return nullptr;
  return &trial.later[number - 2];
}

// Makes a set-point a number like others: it has no uncertainty.
core::Measured Exactly(const std::optional<double>& value) {
  if (!value) return core::AbsentBecause("not set");
  return core::Estimate{*value, 0.0, std::nullopt};
}

// Returns the measured number that a field is, in SI.
// Nothing where the field is no number of a unit.
std::optional<core::Measured> FieldNumber(const core::Trial& trial,
                                          const Field& field) {
  // These are temperature, humidity and the rig's settings.
  if (field.prefix == kOfConditions) {
    for (const auto& quantity : db::kConditionQuantities) {
      if (field.column == quantity.name) {
        return trial.conditions.value_or(core::Conditions{}).*quantity.member;
      }
    }
    return std::nullopt;
  }
  if (const core::ContactRecord* record = FindContactRecord(trial, field)) {
    for (const auto& quantity : core::kContactQuantities) {
      if (field.column == quantity.name) return core::At(*record, quantity);
    }
  }
  if (!field.prefix.empty()) return std::nullopt;
  for (const auto& quantity : core::kBodyQuantities) {
    if (field.column == quantity.name) return trial.body.*quantity.member;
  }
  if (field.column == "set_angle_rad") return Exactly(trial.set_angle_rad);
  if (field.column == "set_speed_mps") return Exactly(trial.set_speed_mps);
  return std::nullopt;
}

// Returns a budget in one line, in degrees: "localisation 0.0100 deg, ground
// 0.0200 deg".
std::string BudgetText(const core::Budget& budget) {
  std::string text;
  for (const auto& line : budget) {
    text += fmt::format("{}{} {:.4f} deg", text.empty() ? "" : ", ",
                        line.source, line.u / core::kDegree);
  }
  return text.empty() ? "none" : text;
}

// The value of a field of `trial` for a person; `as_is` where it is a word.
std::string FieldText(const core::Trial& trial, const Field& field,
                      const Shown& shown, const std::string& as_is) {
  if (auto number = FieldNumber(trial, field)) {
    if (*number) (*number)->value -= shown.offset;
    return report::WithUOrReason(*number, shown.factor);
  }
  const core::ContactRecord* record = FindContactRecord(trial, field);
  if (record == nullptr) return as_is;
  if (field.column == "p_bounce" && record->state.p_bounce) {
    return report::Probability(*record->state.p_bounce);
  }
  for (const auto& budget : core::kBudgets) {
    if (field.column == fmt::format("{}_budget", budget.name)) {
      return BudgetText(record->contact.*budget.member);
    }
  }
  return as_is;
}

}  // namespace

Json ChangesJson(const core::Trial& before, const core::Trial& after) {
  Json out = Json::array();
  // A new document makes numbers change; that it was made anew says something
  // only where no number did.
  Json document;
  for (const db::Change& change : db::Changes(before, after)) {
    const Field field = SplitField(change.field);
    const Shown shown = ShownAs(field.column);
    const std::string from = FieldText(before, field, shown, change.from);
    const std::string to = FieldText(after, field, shown, change.to);
    if (from == to) continue;  // less than the last digit shown
    Json one = {{"field", std::string(field.prefix) + shown.name},
                {"words", std::string(field.prefix) + Label(shown)},
                {"from", from},
                {"to", to}};
    (change.field == "document" ? document : out).push_back(std::move(one));
  }
  return out.empty() && !document.is_null() ? document : out;
}

Json HistoryJson(const std::vector<db::Revision>& history) {
  Json out = Json::array();
  for (std::size_t i = 0; i < history.size(); ++i) {
    const core::Trial& trial = history[i].trial;
    out.push_back(
        {{"revision", trial.revision},
         {"kind", db::Name(history[i].kind)},
         {"who", trial.author},
         {"why", trial.reason},
         {"when", trial.recorded_at_utc},
         {"changes",
          i == 0 ? Json::array()
                 // A revision is compared with the one in force before it,
                 // which is not always the one before it in the list: proposals
                 // stand between.
                 : ChangesJson(db::RevisionInForce({history.data(), i}).trial,
                               trial)}});
  }
  return out;
}

}  // namespace touchdown::review
