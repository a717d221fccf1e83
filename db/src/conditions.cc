#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "register_rows.h"
#include "rows.h"

namespace touchdown::db {
namespace {

using core::Conditions;

// Columns in the order in which they are added and taken.
std::string ConditionNames() {
  std::string names = "anomaly, anomaly_note";
  for (const auto& quantity : kConditionQuantities) {
    names += ", " + MeasuredNames(quantity.name);
  }
  for (const auto& entry : kConditionEntries) {
    names += fmt::format(", {}_id", Name(entry.kind));
  }
  return names + ", note";
}

[[noreturn]] void RefuseCondition(std::string_view field, double value,
                                  std::string_view must) {
  throw std::invalid_argument(
      fmt::format("conditions: {} is {}, must be {}", field, value, must));
}

using Rows = std::array<std::optional<std::int64_t>, kConditionEntries.size()>;

// Fills in the ids of what is named; the rows of all.
Rows Resolve(Connection& connection, Conditions& conditions) {
  Rows rows;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ConditionEntry& entry = kConditionEntries.at(i);
    core::Registered& registered = conditions.*entry.member;
    rows.at(i) = RowOf(connection, entry.kind, registered,
                       fmt::format("conditions: {}", Name(entry.kind)));
    registered = SelectRegistered(connection, entry.kind, rows.at(i));
  }
  return rows;
}

}  // namespace

Conditions Resolved(const Store& store, const Conditions& conditions) {
  Transaction snapshot(store.connection(), Transaction::Kind::kRead);
  Conditions resolved = conditions;
  Resolve(store.connection(), resolved);
  return resolved;
}

bool NameEntries(const Conditions& conditions) {
  return std::ranges::any_of(kConditionEntries, [&](const auto& entry) {
    return !(conditions.*entry.member).name.empty();
  });
}

void RequireStorable(const Conditions& conditions) {
  for (const auto& quantity : kConditionQuantities) {
    RequireMeasured(fmt::format("conditions: {}", quantity.name),
                    conditions.*quantity.member);
  }
  if (const auto& k = conditions.temperature_k;
      k && !(k->value > 0.0 && std::isfinite(k->value))) {
    RefuseCondition("temperature_k", k->value, "above 0 and finite");
  }
  if (const auto& share = conditions.relative_humidity;
      share && !(share->value >= 0.0 && share->value <= 1.0)) {
    RefuseCondition("relative_humidity", share->value, "in 0 .. 1");
  }
  for (const auto& [name, length] :
       {std::pair("compression_m", &conditions.compression_m),
        std::pair("muzzle_height_m", &conditions.muzzle_height_m)}) {
    if (*length &&
        !((*length)->value >= 0.0 && std::isfinite((*length)->value))) {
      RefuseCondition(name, (*length)->value, "at least 0 and finite");
    }
  }
  if (const auto& rad = conditions.elevation_rad;
      rad && !(std::abs(rad->value) <= std::numbers::pi / 2)) {
    RefuseCondition("elevation_rad", rad->value, "from -pi/2 to pi/2");
  }
  if (conditions.anomaly == core::Anomaly::kOther &&
      conditions.anomaly_note.empty()) {
    throw std::invalid_argument(
        "conditions: anomaly is 'other', and its note is empty, must say what");
  }
}

std::optional<std::int64_t> KeepConditions(
    Connection& connection, std::int64_t revision_row,
    const std::optional<Conditions>& stated,
    std::optional<std::int64_t> in_force) {
  if (!stated) return std::nullopt;
  Conditions meant = *stated;
  const Rows rows = Resolve(connection, meant);
  if (in_force && SelectConditions(connection, *in_force) == meant) {
    return in_force;
  }
  static const std::string sql = fmt::format(
      "INSERT INTO conditions (revision_id, {}) VALUES ({})", ConditionNames(),
      Placeholders(4 + 5 * kConditionQuantities.size() + rows.size()));
  Statement insert(connection, sql);
  insert.Add(revision_row)
      .Add(core::Name(meant.anomaly))
      .Add(meant.anomaly_note);
  for (const auto& quantity : kConditionQuantities) {
    AddMeasured(insert, meant.*quantity.member);
  }
  for (const auto& row : rows) insert.Add(row);
  insert.Add(meant.note);
  insert.Run();
  return revision_row;
}

Conditions SelectConditions(Connection& connection, std::int64_t row) {
  static const std::string sql = fmt::format(
      "SELECT {} FROM conditions WHERE revision_id = ?", ConditionNames());
  Statement select(connection, sql);
  select.Add(row);
  Conditions conditions;
  if (!select.Step()) return conditions;
  // The column's CHECK allows these words only.
  conditions.anomaly = core::ParseAnomaly(select.TakeText())
                           .value_or(core::Anomaly::kNotRecorded);
  conditions.anomaly_note = select.TakeText();
  for (const auto& quantity : kConditionQuantities) {
    conditions.*quantity.member = TakeMeasured(select);
  }
  for (const auto& entry : kConditionEntries) {
    conditions.*entry.member =
        SelectRegistered(connection, entry.kind, select.TakeOptionalInteger());
  }
  conditions.note = select.TakeText();
  return conditions;
}

}  // namespace touchdown::db
