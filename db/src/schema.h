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
//   1  the first
//   2  no clip, campaign or contact can be replaced by another program either
inline constexpr std::int64_t kSchemaVersion = 2;

// All tables, indexes and triggers of version kSchemaVersion.
std::string SchemaSql();

// Brings the tables of version `from_version` to the next one. Call inside a
// write transaction. A step is frozen with the version it leads to: where a
// later version changes what a step uses, the step keeps the text of its time.
void Upgrade(Connection& connection, std::int64_t from_version);

// Makes the tables in a file that has none. Call inside a write transaction.
void CreateSchema(Connection& connection, std::string_view store_uuid,
                  std::string_view now_utc);

}  // namespace touchdown::db
