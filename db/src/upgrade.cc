#include <fmt/format.h>

#include <stdexcept>
#include <vector>

#include "chain.h"
#include "old_digests.h"
#include "register_rows.h"
#include "rows.h"
#include "schema.h"
#include "schema_parts.h"
#include "statement.h"
#include "touchdown/core/errors.h"

namespace touchdown::db {
namespace {

// The text of `CREATE TABLE name ...` of today's schema.
std::string TableSql(std::string_view name) {
  const std::string schema = SchemaSql();
  const std::size_t begin = schema.find(fmt::format("CREATE TABLE {} (", name));
  return schema.substr(begin, schema.find(";\n", begin) - begin);
}

// Exchanges the text of tables for today's where what is stored stays as it is
// (sqlite.org/lang_altertable.html, section 8).
void ExchangeText(Connection& connection,
                  std::initializer_list<std::string_view> tables) {
  const std::int64_t cookie = connection.Integer("PRAGMA schema_version");
  sqlite3_db_config(connection.handle(), SQLITE_DBCONFIG_DEFENSIVE, 0, nullptr);
  connection.Execute("PRAGMA writable_schema = ON");
  for (const std::string_view table : tables) {
    Statement(connection,
              "UPDATE sqlite_schema SET sql = ? WHERE type = 'table' AND name "
              "= ?")
        .Add(TableSql(table))
        .Add(table)
        .Run();
  }
  connection.Execute(
      fmt::format("PRAGMA schema_version = {}; PRAGMA writable_schema = RESET",
                  cookie + 1));
  sqlite3_db_config(connection.handle(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
}

// Version 2: checks and guards say the same in a form that makes no temporary
// tables. (Version 3 makes the other tables anew.)
void UpgradeFrom1(Connection& connection) {
  ExchangeText(connection, {"campaigns", "trials", "statements", "contacts",
                            "budget_lines"});
}

// How a table of the register was in version 2.
struct Table2 {
  RegisterKind kind;
  std::string columns;  // of version 3, and what they were in version 2
  std::string were;
};

std::vector<Table2> RegisterOf2() {
  const auto measured = [](std::initializer_list<std::string_view> names) {
    std::string columns;
    for (const auto& name : names) columns += ", " + MeasuredNames(name);
    return columns;
  };
  const std::string camera = "maker, model, serial, firmware, lens, note";
  const std::string sizes =
      measured({"diameter_m", "long_m", "short_m", "mass_kg"});
  const std::string coil =
      measured({"wire_diameter_m", "coil_diameter_m", "active_coils",
                "shear_modulus_pa", "stiffness_n_per_m"});
  const std::string surface =
      "condition, friction_method, note" + measured({"friction"});
  return {
      {RegisterKind::kRig, "name, note, document, sha256",
       "name, note, '', ''"},
      {RegisterKind::kCamera, "name, " + camera, "name, " + camera},
      {RegisterKind::kSpring, "name, rig_id, coil_diameter_kind, note" + coil,
       "label, rig_id, coil_diameter_kind, note" + coil},
      {RegisterKind::kCalibration,
       "name, camera_id, contents, made_on, document, sha256, note",
       "name, camera_id, kind, made_at_utc, document_json, sha256, note"},
      {RegisterKind::kBody, "name, shape, material, note" + sizes,
       "label, kind, material, note" + sizes},
      {RegisterKind::kSurface, "name, " + surface, "name, " + surface},
      {RegisterKind::kOperator, "name, note", "name, note"},
  };
}

// Version 3: the register is kept in versions, which nobody changes, and a
// revision knows the conditions in force. When an entry was made, and by whom,
// version 2 did not record: it bears the store's own date.
void UpgradeFrom2(Connection& connection) {
  const std::string schema = RegisterSql();
  for (const Table2& old : RegisterOf2()) {
    const std::string_view table = FindTable(old.kind).table;
    const std::size_t begin =
        schema.find(fmt::format("CREATE TABLE {} (", table));
    const std::size_t end = schema.find("CREATE TABLE ", begin + 1);
    connection.Execute(fmt::format(
        "ALTER TABLE {0} RENAME TO old_{0};"
        "{1}"
        "INSERT INTO {0} (id, uuid, version, author, reason, recorded_at_utc, "
        "{2}) SELECT id, uuid, 1, 'touchdown', 'entered in version 2', "
        "(SELECT created_at_utc FROM store), {3} FROM old_{0};"
        "DROP TABLE old_{0};",
        table, schema.substr(begin, end - begin), old.columns, old.were));
  }
  // Renaming followed the references to the tables renamed; the text of today
  // refers to the new ones. A column at the end that a row does not have yet is
  // NULL in it.
  ExchangeText(connection, {"campaigns", "conditions", "revisions"});
  connection.Execute(
      "UPDATE revisions SET conditions_id = (SELECT c.revision_id "
      "FROM conditions c JOIN revisions b ON b.id = c.revision_id "
      "WHERE b.trial_id = revisions.trial_id AND b.number <= revisions.number "
      "ORDER BY b.number DESC LIMIT 1) "
      "WHERE EXISTS (SELECT 1 FROM conditions)");
}

// Version 4: a contact has its extrapolated gap, and a revision may be a
// proposal. The new columns stand at the end of the table, so a row that does
// not have them yet reads NULL there.
void UpgradeFrom3(Connection& connection) {
  ExchangeText(connection, {"contacts", "revisions"});
  connection.Execute(
      "UPDATE contacts SET extrapolated_gap_m_absent = "
      "'logged before it was measured'");
}

// Version 8: a chain in place of the digests, and more conditions, which are
// NULL in the rows that are there.
void UpgradeFrom7(Connection& connection) {
  connection.Execute(
      "DROP TABLE IF EXISTS digests; DROP TABLE IF EXISTS clip_digests; "
      "DROP TABLE IF EXISTS plan_digests;");
  ExchangeText(connection, {"conditions"});
  connection.Execute(ChainSql());
  KeepAllLinks(connection);
}

// Triggers and views, which are made anew at the end.
void DropProgram(Connection& connection) {
  std::string drop;
  Statement row(connection,
                "SELECT 'DROP ' || type || ' \"' || name || '\";' FROM "
                "sqlite_schema WHERE type = 'trigger' OR type = 'view'");
  while (row.Step()) drop += row.TakeText();
  connection.Execute(drop);
}

void RequireAsRecorded(Connection& connection, std::int64_t version) {
  std::vector<std::string> problems;
  CheckOldDigests(connection, version, problems);
  if (problems.empty()) return;
  throw core::StoreError(fmt::format(
      "{}: {}, and was not upgraded; go back to a backup, or see `touchdown db "
      "check` of the version that made it",
      connection.path().string(), problems.front()));
}

}  // namespace

void Upgrade(Connection& connection, std::int64_t from_version) {
  RequireAsRecorded(connection, from_version);
  DropProgram(connection);
  for (std::int64_t version = from_version; version < kSchemaVersion;
       ++version) {
    switch (version) {
      case 1:
        UpgradeFrom1(connection);
        break;
      case 2:
        UpgradeFrom2(connection);
        break;
      case 3:
        UpgradeFrom3(connection);
        break;
      case 5:
        connection.Execute(PlanSql());
        break;
      case 4:  // the digests of versions 5 and 7 are no more
      case 6:
      case 8:  // a view
        break;
      case 7:
        UpgradeFrom7(connection);
        break;
      default:
        throw std::logic_error(fmt::format(
            "there is no step from version {} of the store", version));
    }
  }
  connection.Execute(ViewsSql() + TriggersSql());
}

}  // namespace touchdown::db
