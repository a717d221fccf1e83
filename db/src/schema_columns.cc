#include "schema_columns.h"

#include <fmt/format.h>

#include <algorithm>

#include "touchdown/core/quantities.h"

namespace touchdown::db {
namespace {

// Present (value and u, perhaps an interval) or absent with a reason.
std::string MeasuredColumns(std::string_view name) {
  return fmt::format(
      "{0} ANY, {0}_u ANY, {0}_low ANY, {0}_high ANY, {0}_absent TEXT,\n"
      "  CHECK (CASE WHEN {0} IS NULL THEN {0}_absent IS NOT NULL"
      " AND coalesce({0}_u, {0}_low, {0}_high) IS NULL"
      " ELSE {0}_absent IS NULL AND typeof({0}) = 'real'"
      " AND typeof({0}_u) = 'real' AND {0}_u >= 0"
      " AND typeof({0}_low) IN ('real', 'null')"
      " AND typeof({0}_high) = typeof({0}_low)"
      " AND coalesce({0}_low <= {0}_high, 1) END)",
      name);
}

}  // namespace

// A real number, bit for bit. The type is ANY because SQLite keeps a REAL that
// is a whole number as an integer and so forgets the sign of -0.0; the check
// keeps everything but reals out.
std::string Real(std::string_view name) {
  return fmt::format("{0} ANY NOT NULL CHECK (typeof({0}) = 'real')", name);
}

std::string OptionalReal(std::string_view name) {
  return fmt::format("{0} ANY CHECK (typeof({0}) IN ('real', 'null'))", name);
}

std::string Flag(std::string_view name) {
  return fmt::format("{0} INTEGER NOT NULL CHECK ({0} IN (0, 1))", name);
}

// One of some words, "'dry', 'wet'". Compared one by one: for IN with more than
// two, SQLite makes a temporary table for each row (a quarter of the time of a
// bulk import).
std::string WordCondition(std::string_view name, std::string_view words) {
  std::string check;
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(", "), words.size());
    check += fmt::format("{}{} = {}", check.empty() ? "" : " OR ", name,
                         words.substr(0, end));
    words.remove_prefix(std::min(end + 2, words.size()));
  }
  return check;
}

std::string Word(std::string_view name, std::string_view words) {
  return fmt::format("{} TEXT NOT NULL CHECK ({})", name,
                     WordCondition(name, words));
}

std::string Stamp(std::string_view name) {
  return fmt::format(
      "{0} TEXT NOT NULL CHECK ({0} GLOB '[0-9][0-9][0-9][0-9]-[0-9][0-9]-"
      "[0-9][0-9]T[0-9][0-9]:[0-9][0-9]:[0-9][0-9].[0-9][0-9][0-9]Z')",
      name);
}

Group MeasuredGroup(std::string_view name) {
  const std::string both = MeasuredColumns(name);
  const auto split = both.find(",\n");
  return {both.substr(0, split), both.substr(split + 2)};
}

Group LaterMeasuredGroup(std::string_view name) {
  Group group = MeasuredGroup(name);
  const std::string is_stated = fmt::format("{}_absent IS NOT NULL", name);
  const std::size_t at = group.checks.find(is_stated);
  group.checks.erase(at, is_stated.size() + std::string_view(" AND ").size());
  return group;
}

Group BodyGroup() {
  Group group{
      "body_kind TEXT NOT NULL CHECK (body_kind IN ('sphere', 'rectangle'))",
      ""};
  for (const auto& quantity : core::kBodyQuantities) {
    const Group one = MeasuredGroup(quantity.name);
    group.columns += ",\n  " + one.columns;
    group.checks += (group.checks.empty() ? "" : ",\n") + one.checks;
  }
  return group;
}

Group ContactGroup() {
  Group group;
  for (const auto& quantity : core::kContactQuantities) {
    const Group one = MeasuredGroup(quantity.name);
    group.columns += (group.columns.empty() ? "  " : ",\n  ") + one.columns;
    group.checks += (group.checks.empty() ? "" : ",\n") + one.checks;
  }
  return group;
}

}  // namespace touchdown::db
