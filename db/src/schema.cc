#include "schema.h"

#include <fmt/format.h>

#include "chain.h"
#include "schema_columns.h"
#include "schema_parts.h"

namespace touchdown::db {
namespace {

// As CHECK constraints list them.
constexpr std::string_view kAngleKinds = "'approach', 'radius', 'face'";

std::string Evidence() {
  const Group body = BodyGroup();
  const Group contact = ContactGroup();
  const std::string angle_kind = Word("angle_kind", kAngleKinds);
  std::string sql;
  sql += fmt::format(
      "CREATE TABLE campaigns (\n"
      "  id INTEGER PRIMARY KEY,\n"
      "  {uuid},\n"
      "  name TEXT NOT NULL UNIQUE CHECK (name <> ''),\n"
      "  {body},\n"
      "  surface_id INTEGER REFERENCES surfaces (id),\n"
      "  {angle_kind},\n"
      "  {height},\n  {speed_min},\n  {speed_max},\n"
      "  theory_name TEXT NOT NULL,\n"
      "  {theory},\n  {theory_u},\n  {margin},\n"
      "  {created},\n"
      "  CHECK (bounce_height_m > 0 AND margin_rad > 0),\n"
      "  CHECK (0 <= speed_min_mps AND speed_min_mps <= speed_max_mps),\n"
      "{checks}\n) STRICT;\n",
      fmt::arg("uuid", kUuid), fmt::arg("body", body.columns),
      fmt::arg("checks", body.checks), fmt::arg("angle_kind", angle_kind),
      fmt::arg("height", Real("bounce_height_m")),
      fmt::arg("speed_min", Real("speed_min_mps")),
      fmt::arg("speed_max", Real("speed_max_mps")),
      fmt::arg("theory", OptionalReal("theory_boundary_rad")),
      fmt::arg("theory_u", Real("theory_u_rad")),
      fmt::arg("margin", Real("margin_rad")),
      fmt::arg("created", Stamp("created_at_utc")));
  sql += fmt::format(
      "CREATE TABLE clips (\n"
      "  id INTEGER PRIMARY KEY,\n"
      "  clip_id TEXT NOT NULL CHECK (clip_id <> ''),\n"
      "  sha256 TEXT CHECK (sha256 <> ''),\n"  // NULL: not computed yet
      "  size_bytes INTEGER NOT NULL CHECK (size_bytes >= 0),\n"
      "  last_seen_path TEXT NOT NULL,\n"
      "  {},\n"
      "  UNIQUE (clip_id, sha256)\n) STRICT;\n"
      "CREATE INDEX clips_by_sha256 ON clips (sha256);\n",
      Stamp("last_seen_at_utc"));
  sql += fmt::format(
      "CREATE TABLE trials (\n"
      "  id INTEGER PRIMARY KEY,\n"
      "  {},\n"
      "  campaign_id INTEGER REFERENCES campaigns (id),\n"
      "  clip_id INTEGER REFERENCES clips (id),\n"
      "  {},\n"
      "  {}\n) STRICT;\n"
      // One trial per clip and campaign; also finds the trials of a campaign.
      "CREATE UNIQUE INDEX trials_by_campaign_and_clip\n"
      "  ON trials (ifnull(campaign_id, 0), clip_id);\n"
      "CREATE INDEX trials_by_date ON trials (logged_at_utc);\n",
      kUuid, Word("origin", "'recorded', 'simulated', 'manual'"),
      Stamp("logged_at_utc"));
  sql += fmt::format(
      "CREATE TABLE revisions (\n"
      "  id INTEGER PRIMARY KEY,\n"
      "  {},\n"
      "  trial_id INTEGER NOT NULL REFERENCES trials (id),\n"
      "  number INTEGER NOT NULL CHECK (number >= 1),\n"
      "  {},\n"
      // Whose statement is in force: this revision's own, or an earlier one's.
      "  statement_id INTEGER NOT NULL REFERENCES statements (revision_id),\n"
      // The exclusion in force; NULL: the trial counts.
      "  exclusion_id INTEGER REFERENCES exclusions (revision_id),\n"
      "  author TEXT NOT NULL CHECK (author <> ''),\n"
      "  reason TEXT NOT NULL,\n"
      "  {},\n"
      // The conditions in force; NULL: none were ever stated.
      "  conditions_id INTEGER REFERENCES conditions (revision_id),\n"
      "  UNIQUE (trial_id, number)\n) STRICT;\n",
      kUuid,
      Word("kind",
           "'logged', 'corrected', 'excluded', 'included', 'merged', "
           "'proposed'"),
      Stamp("recorded_at_utc"));
  // A revision and what it states name each other. The statement goes in first
  // (its key is checked at the commit): the other way round SQLite would search
  // all revisions for each statement.
  constexpr std::string_view kOfRevision =
      "revision_id INTEGER PRIMARY KEY REFERENCES revisions (id)\n"
      "    DEFERRABLE INITIALLY DEFERRED";
  sql += fmt::format(
      "CREATE TABLE exclusions (\n"
      "  {},\n"
      "  reason TEXT NOT NULL\n) STRICT;\n",
      kOfRevision);
  sql += fmt::format(
      "CREATE TABLE statements (\n"
      "  {},\n"
      "  clip_path TEXT NOT NULL,\n"
      "  {},\n"
      "  {},\n"
      "  {},\n  {},\n"
      "  contacts INTEGER NOT NULL CHECK (contacts >= 1),\n"
      "  software_version TEXT NOT NULL,\n"
      "  options_hash TEXT NOT NULL,\n"
      "  document_json TEXT NOT NULL,\n"
      "{}\n) STRICT;\n",
      kOfRevision, angle_kind, body.columns, OptionalReal("set_angle_rad"),
      OptionalReal("set_speed_mps"), body.checks);
  sql += fmt::format(
      "CREATE TABLE contacts (\n"
      "  revision_id INTEGER NOT NULL REFERENCES statements (revision_id),\n"
      "  ordinal INTEGER NOT NULL CHECK (ordinal >= 0),\n"
      "  {},\n"
      "  not_found_because TEXT NOT NULL,\n"
      "  {},\n"
      "  corner TEXT CHECK ({}),\n"
      "  {},\n"
      "  {},\n"
      "  state_because TEXT NOT NULL,\n"
      "  {},\n"
      "{},\n"
      "  PRIMARY KEY (revision_id, ordinal),\n"
      "{}\n) STRICT;\n",
      Flag("found"), Flag("from_start"),
      WordCondition("corner", "'leading', 'trailing', 'flush'"),
      Word("state",
           "'bounce', 'slide', 'roll-slide', 'roll', 'stick', 'stays-down', "
           "'undecided'"),
      OptionalReal("p_bounce"), Flag("micro_bounce"), contact.columns,
      contact.checks);
  sql += fmt::format(
      "CREATE TABLE budget_lines (\n"
      "  revision_id INTEGER NOT NULL,\n"
      "  ordinal INTEGER NOT NULL,\n"
      "  {},\n"
      "  line INTEGER NOT NULL CHECK (line >= 0),\n"
      "  source TEXT NOT NULL,\n"
      "  {},\n"
      "  PRIMARY KEY (revision_id, ordinal, budget, line),\n"
      "  FOREIGN KEY (revision_id, ordinal)\n"
      "    REFERENCES contacts (revision_id, ordinal)\n"
      ") STRICT, WITHOUT ROWID;\n",
      Word("budget", "'approach', 'attitude'"), Real("u_rad"));
  return sql;
}

}  // namespace

std::string ChainSql() {
  return "CREATE TABLE chain (\n"
         "  number INTEGER PRIMARY KEY CHECK (number >= 1),\n"
         "  subject TEXT NOT NULL,\n"
         "  key TEXT NOT NULL,\n"
         "  row_sha256 TEXT NOT NULL CHECK (length(row_sha256) = 64),\n"
         "  sha256 TEXT NOT NULL CHECK (length(sha256) = 64),\n"
         "  UNIQUE (subject, key)\n) STRICT;\n";
}

std::string PlanSql() {
  return fmt::format(
      "CREATE TABLE plan_events (\n"
      "  id INTEGER PRIMARY KEY,\n"
      "  {},\n"
      "  campaign_id INTEGER NOT NULL REFERENCES campaigns (id),\n"
      "  {},\n"
      "  design TEXT NOT NULL,\n"
      "  stopping_rule TEXT NOT NULL,\n"
      "  error_rates TEXT NOT NULL,\n"
      "  trials INTEGER NOT NULL CHECK (trials >= 0),\n"
      "  author TEXT NOT NULL CHECK (author <> ''),\n"
      "  reason TEXT NOT NULL,\n"
      "  {}\n) STRICT;\n",
      kUuid, Word("kind", "'plan', 'look'"), Stamp("at_utc"));
}

std::string SchemaSql() {
  return fmt::format(
             "CREATE TABLE store (\n"
             "  id INTEGER PRIMARY KEY CHECK (id = 1),\n"
             "  {},\n  {}\n) STRICT;\n",
             kUuid, Stamp("created_at_utc")) +
         RegisterSql() + Evidence() + PlanSql() + ChainSql() + ViewsSql() +
         TriggersSql();
}

void CreateSchema(Connection& connection, std::string_view store_uuid,
                  std::string_view now_utc) {
  connection.Execute(SchemaSql());
  Statement(connection, "INSERT INTO store VALUES (1, ?, ?)")
      .Add(store_uuid)
      .Add(now_utc)
      .Run();
  KeepLink(connection, "store", store_uuid);
  connection.Execute(
      fmt::format("PRAGMA application_id = {}; "
                  "PRAGMA user_version = {}",
                  kApplicationId, kSchemaVersion));
}

}  // namespace touchdown::db
