// The tables of the store, as SQL.
#pragma once

#include <cstdint>
#include <string>

#include "statement.h"

namespace touchdown::db {

// "TDST": marks an SQLite file as a trial store (PRAGMA application_id).
inline constexpr std::int64_t kApplicationId = 0x54445354;

// The schema this program writes (PRAGMA user_version). Each released version
// has a step from its predecessor in Upgrade and a fixture in tests/db/data.
inline constexpr std::int64_t kSchemaVersion = 1;

// All tables, indexes and triggers of version kSchemaVersion.
std::string SchemaSql();

// Makes the tables in a file that has none. Call inside a write transaction.
void CreateSchema(Connection& connection, std::string_view store_uuid,
                  std::string_view now_utc);

}  // namespace touchdown::db
