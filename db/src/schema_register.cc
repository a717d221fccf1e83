#include <fmt/format.h>

#include "register_rows.h"
#include "schema_columns.h"
#include "schema_parts.h"

namespace touchdown::db {
namespace {

// "dry, wet" as SQL, with what every coded word may also be.
std::string QuotedWords(std::string_view words) {
  std::string sql = "'";
  for (const char c : words) {
    if (c == ' ') continue;
    sql += c == ',' ? std::string("', '") : std::string(1, c);
  }
  return fmt::format("{}', {}", sql, kOpenWords);
}

std::string Reference(RegisterKind kind, std::string_view field) {
  return fmt::format("{}_id INTEGER REFERENCES {} (id)", field,
                     TableOf(kind).table);
}

// Each row is one version of an entry; none is ever changed.
std::string RegisterTableSql(RegisterKind kind) {
  const std::string_view table = TableOf(kind).table;
  std::string sql = fmt::format(
      "CREATE TABLE {} (\n"
      "  id INTEGER PRIMARY KEY,\n"
      "  {},\n"
      "  name TEXT NOT NULL CHECK (name <> ''),\n"
      "  version INTEGER NOT NULL CHECK (version >= 1),\n"
      "  author TEXT NOT NULL CHECK (author <> ''),\n"
      "  reason TEXT NOT NULL,\n"
      "  {}",
      table, kUuid, Stamp("recorded_at_utc"));
  std::string checks;
  for (const RegisterField& field : FieldsOf(kind)) {
    sql += ",\n  ";
    switch (field.type) {
      case FieldType::kText:
        sql += fmt::format("{} TEXT NOT NULL", field.name);
        break;
      case FieldType::kWord:
        sql += Word(field.name, QuotedWords(field.words));
        break;
      case FieldType::kMeasured: {
        const Group one = MeasuredGroup(field.name);
        sql += one.columns;
        checks += ",\n" + one.checks;
        break;
      }
      case FieldType::kEntry:
        sql += Reference(field.entry, field.name);
        break;
    }
  }
  return sql + checks +
         fmt::format(
             "\n) STRICT;\n"
             "CREATE UNIQUE INDEX {0}_by_name\n"
             "  ON {0} (name, version, recorded_at_utc, uuid);\n",
             table);
}

std::string ConditionsSql() {
  std::string columns;
  for (const auto& entry : kConditionEntries) {
    columns += fmt::format("  {},\n", Reference(entry.kind, Name(entry.kind)));
  }
  columns += fmt::format(
      "  {},\n  anomaly_note TEXT NOT NULL",
      Word("anomaly",
           fmt::format("'none', 'rig', 'camera', 'light', 'body', 'surface', "
                       "'operator', {}",
                       kOpenWords)));
  std::string checks;
  for (const auto& quantity : kConditionQuantities) {
    const Group one = quantity.is_later ? LaterMeasuredGroup(quantity.name)
                                        : MeasuredGroup(quantity.name);
    columns += ",\n  " + one.columns;
    checks += ",\n" + one.checks;
  }
  columns += ",\n  note TEXT";
  // Its revision comes after it, as after a statement.
  return fmt::format(
      "CREATE TABLE conditions (\n"
      "  revision_id INTEGER PRIMARY KEY REFERENCES revisions (id)\n"
      "    DEFERRABLE INITIALLY DEFERRED,\n"
      "{}{}\n) STRICT;\n",
      columns, checks);
}

}  // namespace

std::string RegisterSql() {
  std::string sql;
  for (const RegisterKind kind : kRegisterKinds) sql += RegisterTableSql(kind);
  return sql + ConditionsSql();
}

}  // namespace touchdown::db
