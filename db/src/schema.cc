#include "schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "touchdown/db/quantities.h"

namespace touchdown::db {
namespace {

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
std::string OneOf(std::string_view name, std::string_view words) {
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
  return fmt::format("{} TEXT NOT NULL CHECK ({})", name, OneOf(name, words));
}

std::string Stamp(std::string_view name) {
  return fmt::format(
      "{0} TEXT NOT NULL CHECK ({0} GLOB '[0-9][0-9][0-9][0-9]-[0-9][0-9]-"
      "[0-9][0-9]T[0-9][0-9]:[0-9][0-9]:[0-9][0-9].[0-9][0-9][0-9]Z')",
      name);
}

constexpr std::string_view kUuid =
    "uuid TEXT NOT NULL UNIQUE CHECK (length(uuid) = 36)";

// Present (value and u, perhaps an interval) or absent with a reason.
std::string Measured(std::string_view name) {
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

std::string BodyColumns() {
  std::string columns =
      "body_kind TEXT NOT NULL CHECK (body_kind IN ('sphere', 'rectangle'))";
  return columns;
}

// Columns come first and checks after them: SQLite takes no column after a
// table constraint.
struct Group {
  std::string columns;
  std::string checks;
};

Group MeasuredGroup(std::string_view name) {
  const std::string both = Measured(name);
  const auto split = both.find(",\n");
  return {both.substr(0, split), both.substr(split + 2)};
}

Group BodyGroup() {
  Group group{BodyColumns(), ""};
  for (const auto& quantity : kBodyQuantities) {
    const Group one = MeasuredGroup(quantity.name);
    group.columns += ",\n  " + one.columns;
    group.checks += (group.checks.empty() ? "" : ",\n") + one.checks;
  }
  return group;
}

Group ContactGroup() {
  Group group;
  for (const auto& quantity : kContactQuantities) {
    const Group one = MeasuredGroup(quantity.name);
    group.columns += (group.columns.empty() ? "  " : ",\n  ") + one.columns;
    group.checks += (group.checks.empty() ? "" : ",\n") + one.checks;
  }
  return group;
}

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
      "  UNIQUE (trial_id, number)\n) STRICT;\n",
      kUuid,
      Word("kind", "'logged', 'corrected', 'excluded', 'included', 'merged'"),
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
      OneOf("corner", "'leading', 'trailing', 'flush'"),
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

// What a lab keeps a register of. A trial refers to them by `conditions`.
std::string Register() {
  const auto table = [](std::string_view name, std::string_view key,
                        std::initializer_list<std::string> columns,
                        std::initializer_list<std::string_view> measured) {
    std::string sql = fmt::format(
        "CREATE TABLE {} (\n  id INTEGER PRIMARY KEY,\n  {},\n"
        "  {} TEXT NOT NULL UNIQUE CHECK ({} <> '')",
        name, kUuid, key, key);
    std::string checks;
    for (const auto& column : columns) sql += ",\n  " + column;
    for (const auto& quantity : measured) {
      const Group one = MeasuredGroup(quantity);
      sql += ",\n  " + one.columns;
      checks += ",\n" + one.checks;
    }
    return sql + checks + "\n) STRICT;\n";
  };
  const std::string note = "note TEXT NOT NULL DEFAULT ''";
  std::string sql;
  sql += table("surfaces", "name",
               {Word("condition",
                     "'dry', 'damp', 'wet', 'icy', 'loose', 'other', "
                     "'not applicable', 'not recorded'"),
                "friction_method TEXT NOT NULL DEFAULT ''", note},
               {"friction"});
  sql += table("operators", "name", {note}, {});
  sql += table(
      "bodies", "label",
      {Word("kind", "'sphere', 'rectangle', 'other'"),
       Word("material",
            "'steel', 'aluminium', 'glass', 'rubber', 'plastic', 'wood', "
            "'stone', 'concrete', 'other', 'not applicable', 'not recorded'"),
       note},
      {"diameter_m", "long_m", "short_m", "mass_kg"});
  sql += table("rigs", "name", {note}, {});
  sql += table(
      "springs", "label",
      {"rig_id INTEGER REFERENCES rigs (id)",
       Word("coil_diameter_kind", "'mean', 'outer', 'inner', 'not recorded'"),
       note},
      {"wire_diameter_m", "coil_diameter_m", "active_coils", "shear_modulus_pa",
       "stiffness_n_per_m"});
  sql += table(
      "cameras", "name",
      {"maker TEXT NOT NULL DEFAULT ''", "model TEXT NOT NULL DEFAULT ''",
       "serial TEXT NOT NULL DEFAULT ''", "firmware TEXT NOT NULL DEFAULT ''",
       "lens TEXT NOT NULL DEFAULT ''", note},
      {});
  sql += table(
      "calibrations", "name",
      {"camera_id INTEGER REFERENCES cameras (id)",
       Word("kind", "'lens', 'scale', 'ground', 'other'"), Stamp("made_at_utc"),
       "sha256 TEXT NOT NULL DEFAULT ''", "document_json TEXT NOT NULL", note},
      {});
  const Group temperature = MeasuredGroup("temperature_k");
  const Group humidity = MeasuredGroup("relative_humidity");
  sql += fmt::format(
      "CREATE TABLE conditions (\n"
      "  revision_id INTEGER PRIMARY KEY REFERENCES revisions (id),\n"
      "  rig_id INTEGER REFERENCES rigs (id),\n"
      "  spring_id INTEGER REFERENCES springs (id),\n"
      "  camera_id INTEGER REFERENCES cameras (id),\n"
      "  calibration_id INTEGER REFERENCES calibrations (id),\n"
      "  body_id INTEGER REFERENCES bodies (id),\n"
      "  surface_id INTEGER REFERENCES surfaces (id),\n"
      "  operator_id INTEGER REFERENCES operators (id),\n"
      "  {},\n"
      "  anomaly_note TEXT NOT NULL DEFAULT '',\n"
      "  {},\n  {},\n{},\n{}\n) STRICT;\n",
      Word("anomaly",
           "'none', 'rig', 'camera', 'light', 'body', 'surface', 'operator', "
           "'other', 'not recorded'"),
      temperature.columns, humidity.columns, temperature.checks,
      humidity.checks);
  return sql;
}

// Also against INSERT OR REPLACE, which deletes without asking the triggers
// above (other programs leave recursive triggers off); and the numbers of a
// trial's revisions have no gap. One EXISTS a key: with OR inside, SQLite makes
// a temporary table for each row. The id of a row that gives none is -1 here.
std::string InsertTriggers() {
  return "CREATE TRIGGER trials_refuse_REPLACE BEFORE INSERT ON trials\n"
         "WHEN EXISTS (SELECT 1 FROM trials WHERE uuid = NEW.uuid)\n"
         "  OR EXISTS (SELECT 1 FROM trials WHERE id = NEW.id)\n"
         "  OR EXISTS (SELECT 1 FROM trials\n"
         "             WHERE ifnull(campaign_id, 0) = ifnull(NEW.campaign_id, "
         "0)\n"
         "             AND clip_id = NEW.clip_id)\n"
         "BEGIN SELECT raise(ABORT, 'this trial exists already'); END;\n"
         "CREATE TRIGGER revisions_in_order BEFORE INSERT ON revisions\n"
         "WHEN NEW.number <> 1 + (SELECT ifnull(max(number), 0) FROM "
         "revisions\n"
         "                        WHERE trial_id = NEW.trial_id)\n"
         "  OR EXISTS (SELECT 1 FROM revisions WHERE uuid = NEW.uuid)\n"
         "  OR EXISTS (SELECT 1 FROM revisions WHERE id = NEW.id)\n"
         "BEGIN SELECT raise(ABORT, 'revisions are added one after the "
         "other');\n"
         "END;\n"
         "CREATE TRIGGER contacts_refuse_REPLACE BEFORE INSERT ON contacts\n"
         "WHEN NEW.ordinal >= (SELECT contacts FROM statements\n"
         "                     WHERE revision_id = NEW.revision_id)\n"
         "  OR EXISTS (SELECT 1 FROM contacts WHERE ordinal = NEW.ordinal\n"
         "             AND revision_id = NEW.revision_id)\n"
         "  OR EXISTS (SELECT 1 FROM contacts WHERE rowid = NEW.rowid)\n"
         "BEGIN SELECT raise(ABORT, 'contacts is append-only: add a "
         "revision');\n"
         "END;\n"
         "CREATE TRIGGER clips_refuse_REPLACE BEFORE INSERT ON clips\n"
         "WHEN EXISTS (SELECT 1 FROM clips WHERE id = NEW.id)\n"
         "  OR EXISTS (SELECT 1 FROM clips WHERE clip_id = NEW.clip_id\n"
         "             AND sha256 = NEW.sha256)\n"
         "BEGIN SELECT raise(ABORT, 'clips are kept'); END;\n"
         "CREATE TRIGGER campaigns_refuse_REPLACE BEFORE INSERT ON campaigns\n"
         "WHEN EXISTS (SELECT 1 FROM campaigns WHERE id = NEW.id)\n"
         "  OR EXISTS (SELECT 1 FROM campaigns WHERE uuid = NEW.uuid)\n"
         "  OR EXISTS (SELECT 1 FROM campaigns WHERE name = NEW.name)\n"
         "BEGIN SELECT raise(ABORT, 'campaigns are kept'); END;\n";
}

// Nothing is overwritten: evidence may be added to, never changed or removed.
std::string Triggers() {
  std::string sql;
  for (const char* table : {"trials", "revisions", "statements", "contacts",
                            "budget_lines", "exclusions", "conditions"}) {
    for (const char* act : {"UPDATE", "DELETE"}) {
      sql += fmt::format(
          "CREATE TRIGGER {0}_refuse_{1} BEFORE {1} ON {0} BEGIN\n"
          "  SELECT raise(ABORT, '{0} is append-only: add a revision');\n"
          "END;\n",
          table, act);
    }
  }
  for (const char* table : {"statements", "exclusions", "conditions"}) {
    sql += fmt::format(
        "CREATE TRIGGER {0}_refuse_REPLACE BEFORE INSERT ON {0}\n"
        "WHEN EXISTS (SELECT 1 FROM {0} WHERE revision_id = NEW.revision_id)\n"
        "BEGIN SELECT raise(ABORT, '{0} is append-only: add a revision');\n"
        "END;\n",
        table);
  }
  sql +=
      "CREATE TRIGGER budget_lines_refuse_REPLACE BEFORE INSERT ON "
      "budget_lines\n"
      "WHEN EXISTS (SELECT 1 FROM budget_lines\n"
      "             WHERE revision_id = NEW.revision_id\n"
      "             AND ordinal = NEW.ordinal AND budget = NEW.budget\n"
      "             AND line = NEW.line)\n"
      "BEGIN SELECT raise(ABORT, 'budget_lines is append-only: add a "
      "revision');\nEND;\n";
  // A clip's digest, once computed, stays.
  sql +=
      "CREATE TRIGGER clips_keep_digest BEFORE UPDATE ON clips\n"
      "WHEN NEW.clip_id <> OLD.clip_id OR NEW.size_bytes <> OLD.size_bytes\n"
      "  OR (OLD.sha256 IS NOT NULL AND NEW.sha256 IS NOT OLD.sha256)\n"
      "BEGIN SELECT raise(ABORT, 'a clip keeps its digest'); END;\n"
      "CREATE TRIGGER clips_refuse_DELETE BEFORE DELETE ON clips\n"
      "BEGIN SELECT raise(ABORT, 'clips are kept'); END;\n";
  // Conventions are fixed before the first trial.
  sql +=
      "CREATE TRIGGER campaigns_keep_conventions BEFORE UPDATE ON campaigns\n"
      "WHEN EXISTS (SELECT 1 FROM trials WHERE campaign_id = OLD.id)\n"
      "BEGIN SELECT raise(ABORT, 'a campaign with trials keeps its "
      "conventions'); END;\n"
      "CREATE TRIGGER campaigns_refuse_DELETE BEFORE DELETE ON campaigns\n"
      "BEGIN SELECT raise(ABORT, 'campaigns are kept'); END;\n";
  return sql + InsertTriggers();
}

}  // namespace

std::string SchemaSql() {
  return fmt::format(
             "CREATE TABLE store (\n"
             "  id INTEGER PRIMARY KEY CHECK (id = 1),\n"
             "  {},\n  {}\n) STRICT;\n",
             kUuid, Stamp("created_at_utc")) +
         Register() + Evidence() + Triggers();
}

namespace {

// The text of `CREATE TABLE name ...` of today's schema.
std::string TableSql(std::string_view name) {
  const std::string schema = SchemaSql();
  const std::size_t begin = schema.find(fmt::format("CREATE TABLE {} (", name));
  return schema.substr(begin, schema.find(";\n", begin) - begin);
}

// Version 2: the guards against REPLACE also know clips, campaigns and a
// contact's rowid; checks and guards say the same in a form that makes no
// temporary tables. What is stored stays as it is, so the text of a table is
// exchanged in place (sqlite.org/lang_altertable.html, section 8).
void UpgradeFrom1(Connection& connection) {
  connection.Execute(
      "DROP TRIGGER trials_refuse_REPLACE;"
      "DROP TRIGGER revisions_in_order;"
      "DROP TRIGGER contacts_refuse_REPLACE;" +
      InsertTriggers());
  const std::int64_t cookie = connection.Integer("PRAGMA schema_version");
  sqlite3_db_config(connection.handle(), SQLITE_DBCONFIG_DEFENSIVE, 0, nullptr);
  connection.Execute("PRAGMA writable_schema = ON");
  for (const char* table : {"campaigns", "trials", "revisions", "statements",
                            "contacts", "budget_lines", "surfaces", "bodies",
                            "springs", "calibrations", "conditions"}) {
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

}  // namespace

void Upgrade(Connection& connection, std::int64_t from_version) {
  switch (from_version) {
    case 1:
      UpgradeFrom1(connection);
      break;
    default:
      throw std::logic_error(fmt::format(
          "there is no step from version {} of the store", from_version));
  }
}

void CreateSchema(Connection& connection, std::string_view store_uuid,
                  std::string_view now_utc) {
  connection.Execute(SchemaSql());
  Statement(connection, "INSERT INTO store VALUES (1, ?, ?)")
      .Add(store_uuid)
      .Add(now_utc)
      .Run();
  connection.Execute(
      fmt::format("PRAGMA application_id = {}; "
                  "PRAGMA user_version = {}",
                  kApplicationId, kSchemaVersion));
}

}  // namespace touchdown::db
