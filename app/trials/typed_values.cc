#include "app/trials/typed_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "app/text/parse_number.h"
#include "app/trials/statement.h"
#include "touchdown/core/edge_unit.h"
#include "touchdown/db/register.h"

namespace touchdown::pipeline {
namespace {

// "--diameter-mm is '4O', must be a number, ...".
[[noreturn]] void RefuseText(const std::string& flag, const std::string& text,
                             const std::string& form) {
  throw std::invalid_argument(
      fmt::format("{} is '{}', must be {}", flag, text, form));
}

// What `parse` of a flag makes of a field: its message names the flag first.
// The flag is empty, so the message begins with a space, which is dropped:
// FieldError puts the field's name in front.
template <class Parse>
auto OfField(const std::string& field, const Parse& parse) {
  try {
    return parse("");
  } catch (const std::invalid_argument& mistake) {
    throw FieldError(field, std::string(mistake.what()).substr(1));
  }
}

}  // namespace

core::Estimate ParseEstimate(const std::string& flag, const std::string& text,
                             double unit, DefaultU default_u) {
  // The default u is taken before the unit is applied: `absolute` is in the
  // unit that was typed.
  const std::string form =
      "a number, or one with its standard uncertainty as in 40+-0.02";
  const std::size_t sign = text.find("+-");
  const auto value =
      report::ParseNumber<double>(std::string_view(text).substr(0, sign));
  if (!value || !std::isfinite(*value)) RefuseText(flag, text, form);
  if (sign == std::string::npos) {
    return {
        *value * unit,
        std::max(default_u.relative * std::abs(*value), default_u.absolute) *
            unit,
        std::nullopt};
  }
  const auto u =
      report::ParseNumber<double>(std::string_view(text).substr(sign + 2));
  if (!u || !std::isfinite(*u)) RefuseText(flag, text, form);
  if (*u < 0.0) {
    throw std::invalid_argument(fmt::format(
        "{} is '{}', its uncertainty must be at least 0", flag, text));
  }
  return {*value * unit, *u * unit, std::nullopt};
}

std::pair<core::Estimate, core::Estimate> ParseSides(const std::string& flag,
                                                     const std::string& text,
                                                     double unit, DefaultU u) {
  // The sides in the order in which they were typed; core::Rectangle sorts
  // them.
  const std::size_t times = text.find('x');
  if (times == std::string::npos) {
    RefuseText(flag, text, "two lengths as in 60x20");
  }
  return {ParseEstimate(flag, text.substr(0, times), unit, u),
          ParseEstimate(flag, text.substr(times + 1), unit, u)};
}

core::Estimate ParseEstimateField(const std::string& field,
                                  const std::string& text, double unit,
                                  DefaultU u) {
  return OfField(field, [&](const char* flag) {
    return ParseEstimate(flag, text, unit, u);
  });
}

std::pair<core::Estimate, core::Estimate> ParseSidesField(
    const std::string& field, const std::string& text, double unit,
    DefaultU u) {
  return OfField(
      field, [&](const char* flag) { return ParseSides(flag, text, unit, u); });
}

core::Measured ParseMeasured(const std::string& flag, const std::string& text,
                             double unit, double offset) {
  constexpr std::string_view kAbsent = "absent:";
  if (text.starts_with(kAbsent) && text.size() > kAbsent.size()) {
    return core::AbsentBecause(text.substr(kAbsent.size()));
  }
  // A condition without u would be taken as exact, so it is refused.
  if (text.find("+-") == std::string::npos) {
    RefuseText(flag, text,
               "a number with its standard uncertainty as in 40+-0.02, or "
               "absent:REASON");
  }
  core::Estimate estimate = ParseEstimate(flag, text, unit);
  // Only the value moves with the offset (20 degrees Celsius are 293.15 K); a
  // difference of temperatures does not.
  estimate.value += offset;
  return estimate;
}

const std::vector<std::string>& ConditionKeys() {
  static const std::vector<std::string> keys = [] {
    std::vector<std::string> all;
    for (const auto& entry : db::kConditionEntries) {
      // Keys stand in the order of the register's tables, with units as people
      // type them: temperature_k of the store is temperature_c here.
      all.emplace_back(Name(entry.kind));
    }
    for (const auto& quantity : db::kConditionQuantities) {
      const core::EdgeUnit unit = core::AtTheEdge(quantity.name);
      all.push_back(unit.stem + unit.suffix);
    }
    all.insert(all.end(), {"note", "anomaly", "anomaly_note"});
    return all;
  }();
  return keys;
}

bool SetCondition(const std::string& key, const std::string& value,
                  core::Conditions& conditions) {
  for (const auto& entry : db::kConditionEntries) {
    if (key != Name(entry.kind)) continue;
    // Only the name is known here; db::Resolved adds the id of the version in
    // force.
    conditions.*entry.member = {value, ""};
    return true;
  }
  for (const auto& quantity : db::kConditionQuantities) {
    const core::EdgeUnit unit = core::AtTheEdge(quantity.name);
    if (key != unit.stem + unit.suffix) continue;
    conditions.*quantity.member = OfField(key, [&](const char* flag) {
      return ParseMeasured(flag, value, unit.factor, unit.offset);
    });
    return true;
  }
  // Three keys are neither entries nor numbers.
  if (key == "anomaly") {
    const auto word = core::ParseAnomaly(value);
    if (!word) {
      throw FieldError(
          key, fmt::format("is '{}', must be {}", value, kAnomalyWords));
    }
    conditions.anomaly = *word;
    return true;
  }
  if (key == "anomaly_note") {
    conditions.anomaly_note = value;
  } else if (key == "note") {
    conditions.note = value;
  } else {
    return false;
  }
  return true;
}

}  // namespace touchdown::pipeline
