#include "touchdown/db/store.h"

#include <fmt/format.h>

#include <chrono>
#include <stdexcept>
#include <thread>

#include "campaigns.h"
#include "evidence.h"
#include "rows.h"
#include "schema.h"
#include "statement.h"
#include "touchdown/core/errors.h"

namespace touchdown::db {
namespace {

using core::StoreError;
namespace fs = std::filesystem;

Connection::Access ToAccess(OpenMode mode) {
  switch (mode) {
    case OpenMode::kRead:
      return Connection::Access::kRead;
    case OpenMode::kWrite:
      return Connection::Access::kWrite;
    case OpenMode::kCreate:
      break;
  }
  return Connection::Access::kCreate;
}

void RequireReachable(const fs::path& path, OpenMode mode) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_directory(status)) {
    throw StoreError(
        fmt::format("{}: this is a folder; --db expects the name of a file",
                    path.string()));
  }
  if (fs::exists(status)) return;
  if (mode != OpenMode::kCreate) {
    throw StoreError(fmt::format(
        "{}: there is no such trial store; check the path, or make one with "
        "`touchdown campaign new NAME --db {}`",
        path.string(), path.string()));
  }
  const fs::path folder = fs::absolute(path).parent_path();
  if (!fs::is_directory(folder, ignored)) {
    throw StoreError(
        fmt::format("{}: its folder {} does not exist; make it first",
                    path.string(), folder.string()));
  }
}

bool HasTables(Connection& connection) {
  return connection.Integer("SELECT count(*) FROM sqlite_schema") != 0;
}

// The log mode is a property of the file, set once. SQLite refuses to change it
// while another process looks, without asking the busy handler.
void UseWriteAheadLog(Connection& connection, double patience_s) {
  const auto end = std::chrono::steady_clock::now() +
                   std::chrono::duration<double>(patience_s);
  while (true) {
    const int code =
        sqlite3_exec(connection.handle(), "PRAGMA journal_mode = WAL", nullptr,
                     nullptr, nullptr);
    if (code == SQLITE_OK) return;
    if ((code & 0xff) != SQLITE_BUSY ||
        std::chrono::steady_clock::now() > end) {
      connection.Fail(code);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

void RequireOurs(Connection& connection, const fs::path& path) {
  // One snapshot: another process may be making the store right now.
  Transaction snapshot(connection, Transaction::Kind::kRead);
  const std::int64_t id = connection.Integer("PRAGMA application_id");
  const std::int64_t version = connection.Integer("PRAGMA user_version");
  if (id != kApplicationId) {
    throw StoreError(HasTables(connection)
                         ? fmt::format("{}: this is an SQLite file, but not a "
                                       "trial store; choose another --db",
                                       path.string())
                         : fmt::format("{}: this trial store is empty: nothing "
                                       "was ever recorded in it",
                                       path.string()));
  }
  if (version > kSchemaVersion) {
    throw StoreError(fmt::format(
        "{}: this trial store has version {}, and this program knows versions "
        "up to {}; use the touchdown that made it, or a newer one",
        path.string(), version, kSchemaVersion));
  }
  if (version < kSchemaVersion) {
    throw StoreError(fmt::format(
        "{}: this trial store has version {}, and this program needs {}; "
        "upgrade it with `touchdown db migrate --db {}`",
        path.string(), version, kSchemaVersion, path.string()));
  }
}

void RequireStated(std::string_view who, std::string_view why) {
  if (who.empty()) {
    throw std::invalid_argument("who is empty, must name the person");
  }
  if (why.empty()) {
    throw std::invalid_argument("why is empty, must give the reason");
  }
}

// A program that is not told the set-points leaves them as they are.
void KeepSetPoints(Connection& connection, const Head& head,
                   core::Trial& trial) {
  Statement row(connection,
                "SELECT set_angle_rad, set_speed_mps FROM statements WHERE "
                "revision_id = ?");
  row.Add(head.statement_id);
  if (!row.Step()) return;
  const auto angle = row.TakeOptionalReal();
  const auto speed = row.TakeOptionalReal();
  if (!trial.set_angle_rad) trial.set_angle_rad = angle;
  if (!trial.set_speed_mps) trial.set_speed_mps = speed;
}

}  // namespace

struct Store::Impl {
  Impl(const fs::path& path, OpenMode mode, OpenOptions options)
      : connection(path, ToAccess(mode), options.patience_s),
        sources(std::move(options.sources)) {}

  // Within a write transaction.
  Logged Log(const core::Trial& trial);
  Logged Mark(std::string_view id, std::string_view who, std::string_view why,
              bool excluded, std::optional<std::int64_t> seen);

  Connection connection;
  Sources sources;
  std::string uuid;
};

Store Store::Open(const fs::path& path, OpenMode mode, OpenOptions options) {
  RequireReachable(path, mode);
  const double patience_s = options.patience_s;
  auto impl = std::make_unique<Impl>(path, mode, std::move(options));
  Connection& connection = impl->connection;
  if (mode != OpenMode::kRead &&
      sqlite3_db_readonly(connection.handle(), "main") == 1) {
    connection.Fail(SQLITE_READONLY);
  }
  if (mode == OpenMode::kCreate && !HasTables(connection)) {
    UseWriteAheadLog(connection, patience_s);
    Transaction transaction(connection, Transaction::Kind::kWrite);
    // Another process may have been faster.
    if (!HasTables(connection)) {
      CreateSchema(connection, impl->sources.new_uuid(),
                   impl->sources.now_utc());
    }
    transaction.Commit();
  }
  RequireOurs(connection, path);
  Statement row(connection, "SELECT uuid FROM store");
  if (row.Step()) impl->uuid = row.TakeText();
  return Store(std::move(impl));
}

Store::Store(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Store::~Store() = default;
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;

const fs::path& Store::path() const { return impl_->connection.path(); }
const std::string& Store::uuid() const { return impl_->uuid; }
Connection& Store::connection() const { return impl_->connection; }
const Sources& Store::sources() const { return impl_->sources; }

Logged Store::Impl::Log(const core::Trial& trial) {
  RequireStorable(trial);
  if (!trial.id.empty() && !IsUuid(trial.id)) {
    throw std::invalid_argument(fmt::format(
        "trial id is '{}', must be empty or a UUID in lower case", trial.id));
  }
  const std::string now = sources.now_utc();
  const auto campaign = FindCampaignRow(connection, trial);
  const auto clip = KeepClip(connection, trial.clip, now);
  std::optional<TrialRow> row;
  if (!trial.id.empty()) {
    row = FindTrial(connection, trial.id);
  } else if (clip) {
    row = FindTrialOfClip(connection, campaign, *clip);
  }
  const bool is_new = !row;
  if (is_new) {
    if (clip && !trial.id.empty()) {
      if (const auto other = FindTrialOfClip(connection, campaign, *clip)) {
        throw std::invalid_argument(fmt::format(
            "trial id is {}, but this clip is already trial {} of the campaign",
            trial.id, other->uuid));
      }
    }
    row = AddTrial(connection, trial.id.empty() ? sources.new_uuid() : trial.id,
                   campaign, trial.origin, clip, now);
  } else {
    Statement same(connection,
                   "SELECT ifnull(campaign_id, 0) = ? AND ifnull(clip_id, 0) = "
                   "? AND origin = ? FROM trials WHERE id = ?");
    same.Add(campaign.value_or(0)).Add(clip.value_or(0));
    same.Add(core::Name(trial.origin)).Add(row->row);
    if (!same.Step() || !same.TakeBool()) {
      throw std::invalid_argument(fmt::format(
          "trial {} has another campaign, clip or origin ({}) than what is to "
          "be recorded ({}): those of a trial never change",
          row->uuid, row->origin, core::Name(trial.origin)));
    }
  }
  const auto head = is_new ? std::nullopt : FindHead(connection, row->row);
  NewRevision revision;
  revision.uuid = sources.new_uuid();
  revision.recorded_at_utc = now;
  // Only a person includes again what a person excluded.
  revision.own_exclusion = !head || (trial.excluded && !head->exclusion_id);
  // Whoever states none, as a re-analysis does, leaves those that were stated.
  revision.own_conditions = trial.conditions.has_value();
  // An analysis has its document. It never takes the place of what a person
  // corrected.
  if (head && !trial.document_json.empty() && IsCorrected(connection, *head)) {
    revision.kind = RevisionKind::kProposed;
    revision.own_exclusion = false;
    core::Trial proposal = trial;
    KeepSetPoints(connection, *head, proposal);
    const std::int64_t number =
        AddRevision(connection, row->row, head, revision, proposal);
    return {row->uuid, number, false, true};
  }
  const std::int64_t number =
      AddRevision(connection, row->row, head, revision, trial);
  return {row->uuid, number, is_new, false};
}

Logged Store::LogTrial(const core::Trial& trial) {
  Transaction transaction(impl_->connection, Transaction::Kind::kWrite);
  Logged logged = impl_->Log(trial);
  transaction.Commit();
  return logged;
}

std::vector<Logged> Store::LogTrials(std::span<const core::Trial> trials) {
  std::vector<Logged> logged;
  logged.reserve(trials.size());
  Transaction transaction(impl_->connection, Transaction::Kind::kWrite);
  for (const auto& trial : trials) {
    try {
      logged.push_back(impl_->Log(trial));
    } catch (const std::invalid_argument& error) {
      throw TrialRefused(logged.size(), error.what());
    }
  }
  transaction.Commit();
  return logged;
}

namespace {

// `seen` is the revision that a person looked at.
void RequireLast(const std::filesystem::path& path, std::string_view id,
                 std::int64_t last, std::int64_t seen) {
  if (last == seen) return;
  throw StoreError(fmt::format(
      "{}: trial {} was revised meanwhile (revision {}, not {}); look at it "
      "again and repeat",
      path.string(), id, last, seen));
}

}  // namespace

Logged Store::Correct(const core::Trial& seen, std::string_view who,
                      std::string_view why) {
  RequireStated(who, why);
  core::Trial trial = seen;
  trial.author = who;
  trial.reason = why;
  RequireStorable(trial);
  Connection& connection = impl_->connection;
  Transaction transaction(connection, Transaction::Kind::kWrite);
  const auto row = FindTrial(connection, trial.id);
  const auto head = row ? FindHead(connection, row->row) : std::nullopt;
  if (!head) {
    throw StoreError(
        fmt::format("{}: there is no trial {}; see `touchdown list`",
                    path().string(), trial.id));
  }
  RequireLast(path(), trial.id, head->number, seen.revision);
  // The campaign's kinds bind a correction too.
  FindCampaignRow(connection, trial);
  NewRevision revision;
  revision.uuid = impl_->sources.new_uuid();
  revision.kind = RevisionKind::kCorrected;
  revision.recorded_at_utc = impl_->sources.now_utc();
  revision.own_exclusion = false;
  const std::int64_t number =
      AddRevision(connection, row->row, head, revision, trial);
  transaction.Commit();
  return {row->uuid, number, false, false};
}

Logged Store::Impl::Mark(std::string_view id, std::string_view who,
                         std::string_view why, bool excluded,
                         std::optional<std::int64_t> seen) {
  RequireStated(who, why);
  Transaction transaction(connection, Transaction::Kind::kWrite);
  const auto row = FindTrial(connection, id);
  const auto head = row ? FindHead(connection, row->row) : std::nullopt;
  if (!head) {
    throw StoreError(
        fmt::format("{}: there is no trial {}; see `touchdown list`",
                    connection.path().string(), id));
  }
  if (seen) RequireLast(connection.path(), id, head->number, *seen);
  if (head->exclusion_id.has_value() == excluded) {
    throw std::invalid_argument(fmt::format(
        "trial {} is {} already", id, excluded ? "excluded" : "included"));
  }
  core::Trial act;
  act.author = who;
  act.reason = why;
  act.excluded = excluded;
  act.exclusion_reason = excluded ? why : "";
  NewRevision revision;
  revision.uuid = sources.new_uuid();
  revision.kind = excluded ? RevisionKind::kExcluded : RevisionKind::kIncluded;
  revision.recorded_at_utc = sources.now_utc();
  revision.own_statement = false;
  revision.own_conditions = false;
  const std::int64_t number =
      AddRevision(connection, row->row, head, revision, act);
  transaction.Commit();
  return {row->uuid, number, false, false};
}

Logged Store::Exclude(std::string_view id, std::string_view who,
                      std::string_view why, std::optional<std::int64_t> seen) {
  return impl_->Mark(id, who, why, true, seen);
}

Logged Store::Include(std::string_view id, std::string_view who,
                      std::string_view why, std::optional<std::int64_t> seen) {
  return impl_->Mark(id, who, why, false, seen);
}

std::vector<core::Trial> Store::Trials(const TrialFilter& filter) const {
  Connection& connection = impl_->connection;
  Transaction snapshot(connection, Transaction::Kind::kRead);
  if (filter.campaign && !filter.campaign->empty() &&
      !FindCampaign(*filter.campaign)) {
    throw NoCampaign(connection, *filter.campaign);
  }
  Statement row(connection, TrialsSql(filter));
  if (filter.campaign) row.Add(*filter.campaign);
  if (filter.origin) row.Add(core::Name(*filter.origin));
  if (filter.body) row.Add(core::Name(*filter.body));
  if (filter.state) row.Add(core::Name(*filter.state));
  if (filter.from_utc) row.Add(*filter.from_utc);
  if (filter.until_utc) row.Add(*filter.until_utc);
  std::vector<core::Trial> trials;
  while (row.Step()) trials.push_back(TakeRevision(connection, row).trial);
  return trials;
}

std::optional<core::Trial> Store::Find(std::string_view id_or_prefix) const {
  // Characters of an id that a person may type: a shorter one is soon that of
  // several trials. Not studied.
  constexpr std::size_t kShortestPrefix = 4;
  std::string prefix(id_or_prefix);
  for (char& c : prefix) {
    if (c >= 'A' && c <= 'F') c = static_cast<char>(c - 'A' + 'a');
    const bool hex = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
    if (!hex && c != '-') return std::nullopt;
  }
  if (prefix.size() < kShortestPrefix) {
    throw std::invalid_argument(
        fmt::format("trial id is '{}', must have at least {} characters",
                    id_or_prefix, kShortestPrefix));
  }
  Connection& connection = impl_->connection;
  Transaction snapshot(connection, Transaction::Kind::kRead);
  // 'g' comes after every character of a UUID.
  Statement find(
      connection,
      "SELECT uuid FROM trials WHERE uuid >= ?1 AND uuid < ?1 || 'g' "
      "ORDER BY uuid LIMIT 3");
  find.Add(prefix);
  std::vector<std::string> found;
  while (find.Step()) found.push_back(find.TakeText());
  if (found.empty()) return std::nullopt;
  if (found.size() > 1) {
    throw StoreError(
        fmt::format("{}: several trials begin with '{}': {}, {}{}; "
                    "give more of the id",
                    path().string(), id_or_prefix, found[0], found[1],
                    found.size() > 2 ? ", ..." : ""));
  }
  Statement row(connection, SelectRevisions(true) +
                                "WHERE t.uuid = ? AND r.kind <> 'proposed' "
                                "ORDER BY r.number DESC LIMIT 1");
  row.Add(found[0]);
  if (!row.Step()) return std::nullopt;
  return TakeRevision(connection, row).trial;
}

std::optional<LastLogged> Store::FindLogged(std::string_view campaign,
                                            std::string_view clip_id) const {
  Connection& connection = impl_->connection;
  Transaction snapshot(connection, Transaction::Kind::kRead);
  Statement row(connection, LastLoggedSql());
  row.Add(campaign).Add(clip_id);
  if (!row.Step()) return std::nullopt;
  LastLogged last;
  last.trial_id = row.TakeText();
  last.options_hash = row.TakeText();
  last.set_angle_rad = row.TakeOptionalReal();
  last.set_speed_mps = row.TakeOptionalReal();
  return last;
}

std::vector<core::Trial> Store::Proposals(std::string_view id) const {
  Connection& connection = impl_->connection;
  Transaction snapshot(connection, Transaction::Kind::kRead);
  // Acts that state nothing of the trial do not close a proposal.
  std::string sql =
      SelectRevisions(true) +
      "WHERE r.kind = 'proposed' AND r.number = (SELECT max(number) FROM "
      "revisions WHERE trial_id = t.id AND kind <> 'excluded' AND kind <> "
      "'included')";
  if (!id.empty()) sql += " AND t.uuid = ?";
  Statement row(connection, sql + " ORDER BY t.id");
  if (!id.empty()) row.Add(id);
  std::vector<core::Trial> proposals;
  while (row.Step()) proposals.push_back(TakeRevision(connection, row).trial);
  return proposals;
}

std::vector<Revision> Store::History(std::string_view id) const {
  Transaction snapshot(impl_->connection, Transaction::Kind::kRead);
  return ReadHistory(impl_->connection, id);
}

void Store::ForEachHistory(
    const std::function<void(const std::vector<Revision>&)>& visit) const {
  Transaction snapshot(impl_->connection, Transaction::Kind::kRead);
  VisitHistories(impl_->connection, visit);
}

}  // namespace touchdown::db
