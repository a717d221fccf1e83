// Columns of the store's tables, as SQL.
#pragma once

#include <string>
#include <string_view>

namespace touchdown::db {

// Column of every table whose rows are named outside.
inline constexpr std::string_view kUuid =
    "uuid TEXT NOT NULL UNIQUE CHECK (length(uuid) = 36)";

// What every coded word may also be.
inline constexpr std::string_view kOpenWords =
    "'other', 'not applicable', 'not recorded'";

// A real number, present or perhaps not.
std::string Real(std::string_view name);
std::string OptionalReal(std::string_view name);
// 0 or 1.
std::string Flag(std::string_view name);
// The condition that a column is one of "'dry', 'wet'"; a column with it.
std::string WordCondition(std::string_view name, std::string_view words);
std::string Word(std::string_view name, std::string_view words);
// UTC with milliseconds (identity.h).
std::string Stamp(std::string_view name);

// Columns come first and checks after them: SQLite takes no column after a
// table constraint.
struct Group {
  std::string columns;
  std::string checks;
};
Group MeasuredGroup(std::string_view name);
// The same where rows of an older version have NULL in all five.
Group LaterMeasuredGroup(std::string_view name);
Group BodyGroup();
Group ContactGroup();

}  // namespace touchdown::db
