#include "touchdown/db/register.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "chain.h"
#include "register_rows.h"
#include "rows.h"
#include "touchdown/core/errors.h"

namespace touchdown::db {
namespace {

using core::Registered;
using core::StoreError;

// Columns of a version, in the order in which InsertEntry and TakeEntry go.
std::string EntryNames(RegisterKind kind) {
  std::string names = "uuid, name, version, author, reason, recorded_at_utc";
  for (const RegisterField& field : ListFields(kind)) {
    switch (field.type) {
      case FieldType::kText:
      case FieldType::kWord:
        names += fmt::format(", {}", field.name);
        break;
      case FieldType::kMeasured:
        names += ", " + MeasuredNames(field.name);
        break;
      case FieldType::kEntry:
        names += fmt::format(", {}_id", field.name);
        break;
    }
  }
  return names;
}

Entry TakeEntry(Connection& connection, Statement& row, RegisterKind kind) {
  Entry entry;
  entry.kind = kind;
  entry.id = row.TakeText();
  entry.name = row.TakeText();
  entry.version = row.TakeInteger();
  entry.author = row.TakeText();
  entry.reason = row.TakeText();
  entry.recorded_at_utc = row.TakeText();
  for (const RegisterField& field : ListFields(kind)) {
    const std::string key(field.name);
    switch (field.type) {
      case FieldType::kText:
      case FieldType::kWord:
        entry.texts[key] = row.TakeText();
        break;
      case FieldType::kMeasured:
        entry.measured.insert_or_assign(key, TakeMeasured(row));
        break;
      case FieldType::kEntry:
        entry.entries[key] = SelectRegistered(connection, field.entry,
                                              row.TakeOptionalInteger());
        break;
    }
  }
  return entry;
}

// The entries of a kind; `tail` is what follows FROM.
std::vector<Entry> SelectEntries(Connection& connection, RegisterKind kind,
                                 std::string_view tail,
                                 std::optional<std::string_view> name = {}) {
  Statement row(connection,
                fmt::format("SELECT {} FROM {} {}", EntryNames(kind),
                            FindTable(kind).table, tail));
  if (name) row.Add(*name);
  std::vector<Entry> entries;
  while (row.Step()) entries.push_back(TakeEntry(connection, row, kind));
  return entries;
}

// Records `entry` as version `number`; within a write transaction.
Entry Record(Store& store, Entry entry, std::int64_t number) {
  entry.id = store.sources().new_uuid();
  entry.version = number;
  entry.recorded_at_utc = store.sources().now_utc();
  InsertEntry(store.connection(), entry);
  return *InForce(store.connection(), entry.kind, entry.name);
}

// Total: equal names and versions differ in time or identity.
constexpr std::string_view kOldestFirst =
    "ORDER BY name, version, recorded_at_utc, uuid";

}  // namespace

Registered SelectRegistered(Connection& connection, RegisterKind kind,
                            std::optional<std::int64_t> row) {
  if (!row) return {};
  Statement find(connection,
                 fmt::format("SELECT name, uuid FROM {} WHERE id = ?",
                             FindTable(kind).table));
  find.Add(*row);
  Registered entry;
  if (find.Step()) {
    entry.name = find.TakeText();
    entry.id = find.TakeText();
  }
  return entry;
}

std::vector<Entry> ReadVersions(Connection& connection) {
  std::vector<Entry> all;
  for (const RegisterKind kind : kRegisterKinds) {
    for (Entry& entry : SelectEntries(connection, kind, kOldestFirst)) {
      all.push_back(std::move(entry));
    }
  }
  return all;
}

std::optional<Entry> InForce(Connection& connection, RegisterKind kind,
                             std::string_view name) {
  auto found = SelectEntries(
      connection, kind,
      fmt::format("WHERE name = ? ORDER BY {} LIMIT 1", kInForceFirst), name);
  if (found.empty()) return std::nullopt;
  return std::move(found.front());
}

std::optional<std::int64_t> FindRow(Connection& connection, RegisterKind kind,
                                    const Registered& entry,
                                    std::string_view field) {
  if (entry.name.empty() && entry.id.empty()) return std::nullopt;
  const std::string_view table = FindTable(kind).table;
  Statement row(connection,
                entry.id.empty()
                    ? fmt::format("SELECT id FROM {} WHERE name = ? ORDER BY "
                                  "{} LIMIT 1",
                                  table, kInForceFirst)
                    : fmt::format("SELECT id FROM {} WHERE uuid = ?2 AND name "
                                  "= ?1",
                                  table));
  row.Add(entry.name);
  if (!entry.id.empty()) row.Add(entry.id);
  if (!row.Step()) {
    throw std::invalid_argument(fmt::format(
        "{} is '{}'{}, must be a {} of the register; {}", field, entry.name,
        entry.id.empty() ? "" : fmt::format(" (version {})", entry.id),
        Name(kind), NameMeant(connection, kind, entry.name)));
  }
  return row.TakeInteger();
}

std::int64_t InsertEntry(Connection& connection, const Entry& entry) {
  const std::string names = EntryNames(entry.kind);
  const auto columns =
      1 + static_cast<std::size_t>(std::ranges::count(names, ','));
  Statement insert(connection, fmt::format("INSERT INTO {} ({}) VALUES ({})",
                                           FindTable(entry.kind).table, names,
                                           Placeholders(columns)));
  insert.Add(entry.id)
      .Add(entry.name)
      .Add(entry.version)
      .Add(entry.author)
      .Add(entry.reason)
      .Add(entry.recorded_at_utc);
  for (const RegisterField& field : ListFields(entry.kind)) {
    switch (field.type) {
      case FieldType::kText:
      case FieldType::kWord:
        insert.Add(entry.texts.find(field.name)->second);
        break;
      case FieldType::kMeasured:
        AddMeasured(insert, entry.measured.find(field.name)->second);
        break;
      case FieldType::kEntry:
        insert.Add(FindRow(connection, field.entry,
                           entry.entries.find(field.name)->second, field.name));
        break;
    }
  }
  insert.Run();
  const std::int64_t row = sqlite3_last_insert_rowid(connection.handle());
  KeepLink(connection, Name(entry.kind), entry.id);
  return row;
}

bool HasVersion(Connection& connection, RegisterKind kind,
                std::string_view uuid) {
  Statement row(connection, fmt::format("SELECT 1 FROM {} WHERE uuid = ?",
                                        FindTable(kind).table));
  row.Add(uuid);
  return row.Step();
}

Entry AddEntry(Store& store, const Entry& entry) {
  RequireStorable(entry);
  Transaction transaction(store.connection(), Transaction::Kind::kWrite);
  if (InForce(store.connection(), entry.kind, entry.name)) {
    throw StoreError(fmt::format(
        "{}: there is a {} '{}' already; choose another name, or change it "
        "with `touchdown register change`",
        store.path().string(), Name(entry.kind), entry.name));
  }
  Entry recorded = Record(store, entry, 1);
  transaction.Commit();
  return recorded;
}

Entry ChangeEntry(Store& store, const Entry& seen) {
  RequireStorable(seen);
  if (seen.reason.empty()) {
    throw std::invalid_argument("reason is empty, must say why this changes");
  }
  Transaction transaction(store.connection(), Transaction::Kind::kWrite);
  const auto head = InForce(store.connection(), seen.kind, seen.name);
  if (!head) {
    throw StoreError(fmt::format(
        "{}: there is no {} '{}'; {}", store.path().string(), Name(seen.kind),
        seen.name, NameMeant(store.connection(), seen.kind, seen.name)));
  }
  if (head->id != seen.id) {
    throw StoreError(fmt::format(
        "{}: {} '{}' was changed meanwhile (version {} by {}); look at it "
        "again and repeat",
        store.path().string(), Name(seen.kind), seen.name, head->version,
        head->author));
  }
  if (Changes(*head, seen).empty()) {
    throw std::invalid_argument(
        fmt::format("nothing of {} '{}' would change; give what is different",
                    Name(seen.kind), seen.name));
  }
  Entry recorded = Record(store, seen, head->version + 1);
  transaction.Commit();
  return recorded;
}

std::optional<Entry> FindEntry(const Store& store, RegisterKind kind,
                               std::string_view name) {
  Transaction snapshot(store.connection(), Transaction::Kind::kRead);
  return InForce(store.connection(), kind, name);
}

std::vector<Entry> Entries(const Store& store, RegisterKind kind) {
  Transaction snapshot(store.connection(), Transaction::Kind::kRead);
  std::vector<Entry> in_force;
  for (Entry& entry : SelectEntries(store.connection(), kind, kOldestFirst)) {
    if (!in_force.empty() && in_force.back().name == entry.name) {
      in_force.back() = std::move(entry);
    } else {
      in_force.push_back(std::move(entry));
    }
  }
  return in_force;
}

std::vector<Entry> AllVersions(const Store& store) {
  Transaction snapshot(store.connection(), Transaction::Kind::kRead);
  return ReadVersions(store.connection());
}

std::vector<Entry> ReadEntryVersions(const Store& store, RegisterKind kind,
                                     std::string_view name) {
  Transaction snapshot(store.connection(), Transaction::Kind::kRead);
  return SelectEntries(store.connection(), kind,
                       fmt::format("WHERE name = ? {}", kOldestFirst), name);
}

}  // namespace touchdown::db
