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
//   3  the register is kept in versions; a revision knows its conditions
//   4  a contact has its extrapolated gap; a revision may be a proposal
//   5  each trial has a digest of its evidence, each clip of its SHA-256
//   6  a campaign has its plan and the looks at its answer on record
//   7  the plan and looks of a campaign have a digest
//   8  a hash chain in place of the digests; what the rig was set to and the
//      operator's note are conditions; views
//   9  of kind face the contact angle of v_trials is a magnitude
// A step leaves NULL in what it adds to rows that are there: their links
// (chain.h) pass over it, and heads that were sealed before stay good.
inline constexpr std::int64_t kSchemaVersion = 9;

// All tables, indexes and triggers of version kSchemaVersion.
std::string SchemaSql();

// Brings the tables of version `from_version` to this program's, step by step;
// triggers are made anew at the end. Call inside a write transaction, foreign
// keys off: tables go and come back meanwhile.
void Upgrade(Connection& connection, std::int64_t from_version);

// Makes the tables in a file that has none. Call inside a write transaction.
void CreateSchema(Connection& connection, std::string_view store_uuid,
                  std::string_view now_utc);

}  // namespace touchdown::db
