// The register as rows, and the conditions that refer to it. Write functions
// belong inside a write transaction.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "statement.h"
#include "touchdown/db/register.h"

namespace touchdown::db {

struct RegisterTable {
  std::string_view word;   // of one entry, in commands and columns
  std::string_view table;  // of all
};
const RegisterTable& FindTable(RegisterKind kind);

// The version in force comes first: the highest number; of two made apart from
// each other, the one recorded later. All machines agree on it.
inline constexpr std::string_view kInForceFirst =
    "version DESC, recorded_at_utc DESC, uuid DESC";

// The row of the version that `entry` means; nothing where it names none.
// Throws std::invalid_argument naming `field` if there is no such entry.
std::optional<std::int64_t> FindRow(Connection& connection, RegisterKind kind,
                                    const core::Registered& entry,
                                    std::string_view field);

// Name and id of the version in `row`; none for nothing.
core::Registered SelectRegistered(Connection& connection, RegisterKind kind,
                                  std::optional<std::int64_t> row);

// What to do where there is no entry of that name: "did you mean 'S 3'?", or
// where the names are (names.cc).
std::string NameMeant(Connection& connection, RegisterKind kind,
                      std::string_view name);

// The version in force; nothing if there is no entry of that name.
std::optional<Entry> InForce(Connection& connection, RegisterKind kind,
                             std::string_view name);
// Every version of every entry, as AllVersions gives them.
std::vector<Entry> ReadVersions(Connection& connection);

// Adds a version as it is (id, number and date included); returns its row.
std::int64_t InsertEntry(Connection& connection, const Entry& entry);
bool HasVersion(Connection& connection, RegisterKind kind,
                std::string_view uuid);

// The conditions of a new revision: nothing where none are stated, `in_force`
// where those say the same, else row `revision_row`, made here.
std::optional<std::int64_t> KeepConditions(
    Connection& connection, std::int64_t revision_row,
    const std::optional<core::Conditions>& stated,
    std::optional<std::int64_t> in_force);
core::Conditions SelectConditions(Connection& connection, std::int64_t row);

// Throws std::invalid_argument naming the field.
void RequireStorable(const core::Conditions& conditions);

}  // namespace touchdown::db
