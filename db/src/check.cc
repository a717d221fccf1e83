#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "chain.h"
#include "register_rows.h"
#include "schema.h"
#include "statement.h"
#include "touchdown/db/clips.h"
#include "touchdown/db/maintenance.h"

namespace touchdown::db {
namespace {

// Every row of `sql` is a problem told by its one text column.
void Collect(Connection& connection, std::string_view sql,
             std::vector<std::string>& problems) {
  Statement row(connection, sql);
  while (row.Step()) problems.push_back(row.TakeText());
}

void CheckFile(Connection& connection, std::vector<std::string>& problems) {
  Statement integrity(connection, "PRAGMA integrity_check");
  while (integrity.Step()) {
    const std::string line = integrity.TakeText();
    if (line != "ok") problems.push_back("file: " + line);
  }
  Statement keys(connection, "PRAGMA foreign_key_check");
  while (keys.Step()) {
    const std::string table = keys.TakeText();
    const auto row = keys.TakeOptionalInteger();
    problems.push_back(
        fmt::format("row {} of {} refers to a row of {} that is "
                    "not there",
                    row.value_or(-1), table, keys.TakeText()));
  }
}

// Every table, index, view and trigger of the schema is there, as this program
// wrote it, and no trigger of another's.
void CheckSchema(Connection& connection, std::vector<std::string>& problems) {
  const std::string schema = SchemaSql();
  // How each statement of the schema begins.
  constexpr std::string_view kCreate = "CREATE ";
  std::set<std::string> triggers;
  for (std::size_t at = 0; at != std::string::npos;) {
    std::istringstream words(schema.substr(at + kCreate.size(), 200));
    std::string type;
    words >> type;
    if (type == "UNIQUE") words >> type;  // of an index
    std::ranges::transform(type, type.begin(),
                           [](char c) { return static_cast<char>(c | 0x20); });
    std::string name;
    words >> name;
    if (type == "trigger") triggers.insert(name);
    Statement find(connection,
                   "SELECT sql FROM sqlite_schema WHERE type = ? AND name = ?");
    find.Add(type).Add(name);
    if (!find.Step()) {
      problems.push_back(fmt::format(
          "{} {} is missing: the store is not guarded", type, name));
    } else if (const std::string sql = find.TakeText();
               schema.compare(at, sql.size(), sql) != 0) {
      problems.push_back(fmt::format(
          "{} {} is not what it was: the store is not guarded", type, name));
    }
    const std::size_t next = schema.find("\nCREATE ", at);
    at = next == std::string::npos ? next : next + 1;
  }
  Statement own(connection,
                "SELECT name FROM sqlite_schema WHERE type = 'trigger'");
  while (own.Step()) {
    const std::string name = own.TakeText();
    if (!triggers.contains(name)) {
      problems.push_back(fmt::format("trigger {} is not this program's", name));
    }
  }
}

void CheckChains(Connection& connection, std::vector<std::string>& problems) {
  Collect(connection,
          "SELECT 'trial ' || uuid || ' has no revision' FROM trials t "
          "WHERE NOT EXISTS (SELECT 1 FROM revisions WHERE trial_id = t.id)",
          problems);
  Collect(
      connection,
      "SELECT 'trial ' || t.uuid || ': its revisions are not numbered 1 to '"
      " || count(*) FROM revisions r JOIN trials t ON t.id = r.trial_id "
      "GROUP BY t.id HAVING min(number) <> 1 OR max(number) <> count(*)",
      problems);
  // What a revision leans on must be of the same trial, and not younger.
  for (const char* column : {"statement_id", "exclusion_id", "conditions_id"}) {
    Collect(connection,
            fmt::format(
                "SELECT 'revision ' || r.uuid || ': its {0} belongs to another "
                "trial or to a later revision' FROM revisions r "
                "JOIN revisions b ON b.id = r.{0} "
                "WHERE b.trial_id <> r.trial_id OR b.number > r.number",
                column),
            problems);
  }
  Collect(connection,
          "SELECT 'revision ' || r.uuid || ' should hold ' || s.contacts || "
          "' contacts, but holds ' || (SELECT count(*) FROM contacts c "
          "WHERE c.revision_id = s.revision_id) "
          "FROM statements s JOIN revisions r ON r.id = s.revision_id "
          "WHERE s.contacts <> (SELECT count(*) FROM contacts c "
          "WHERE c.revision_id = s.revision_id)",
          problems);
  CheckSchema(connection, problems);
}

void CheckClips(const std::vector<KnownClip>& clips, const DigestOf& digest,
                CheckReport& report) {
  std::set<std::string> known;
  for (const KnownClip& clip : clips) {
    if (clip.sha256.empty()) ++report.clips_without_digest;
    known.insert(clip.sha256);
  }
  if (!digest) return;
  // Several clips may have borne one name, one after the other.
  std::map<std::string, std::optional<std::string>> found_at;
  for (const KnownClip& clip : clips) {
    if (clip.sha256.empty()) continue;
    const auto [at, is_new] = found_at.try_emplace(clip.last_seen_path);
    if (is_new) at->second = digest(clip.last_seen_path);
    const auto& found = at->second;
    if (found == clip.sha256) {
      ++report.clips_verified;
    } else if (!found || known.contains(*found)) {
      // Gone, or another recording of the store has its name now.
      report.clips_missing.push_back(clip.last_seen_path);
    } else {
      report.clips_changed.push_back(clip.last_seen_path);
    }
  }
}

}  // namespace

CheckReport Check(const Store& store, const DigestOf& digest) {
  Connection& connection = store.connection();
  CheckReport report;
  std::vector<KnownClip> clips;
  {
    Transaction snapshot(connection, Transaction::Kind::kRead);
    CheckFile(connection, report.problems);
    CheckChains(connection, report.problems);
    CheckChain(connection, report.problems);
    report.campaigns = connection.Integer("SELECT count(*) FROM campaigns");
    for (const RegisterKind kind : kRegisterKinds) {
      report.register_versions += connection.Integer(
          fmt::format("SELECT count(*) FROM {}", FindTable(kind).table));
    }
    report.trials = connection.Integer("SELECT count(*) FROM trials");
    report.revisions = connection.Integer("SELECT count(*) FROM revisions");
    clips = KnownClips(store);
  }
  // Clips are long: read them when the snapshot has been let go.
  CheckClips(clips, digest, report);
  return report;
}

}  // namespace touchdown::db
