#include "evidence.h"

#include <fmt/format.h>

#include <stdexcept>

#include "campaigns.h"
#include "chain.h"
#include "register_rows.h"
#include "rows.h"

namespace touchdown::db {

std::optional<Head> FindHead(Connection& connection, std::int64_t trial_row) {
  Statement row(connection,
                "SELECT (SELECT max(number) FROM revisions WHERE trial_id = "
                "?1), number, uuid, statement_id, exclusion_id, "
                "conditions_id FROM revisions WHERE trial_id = ?1 AND kind <> "
                "'proposed' ORDER BY number DESC LIMIT 1");
  row.Add(trial_row);
  if (!row.Step()) return std::nullopt;
  Head head;
  head.last_number = row.TakeInteger();
  head.number = row.TakeInteger();
  head.uuid = row.TakeText();
  head.statement_id = row.TakeInteger();
  head.exclusion_id = row.TakeOptionalInteger();
  head.conditions_id = row.TakeOptionalInteger();
  return head;
}

bool IsCorrected(Connection& connection, const Head& head) {
  // A revision that settles a merge restates another, of the same person and
  // time.
  Statement row(connection,
                "SELECT 1 FROM revisions s JOIN revisions p ON p.trial_id = "
                "s.trial_id WHERE s.id = ? AND p.kind = 'corrected' AND "
                "p.author = s.author AND p.recorded_at_utc = "
                "s.recorded_at_utc");
  row.Add(head.statement_id);
  return row.Step();
}

std::optional<TrialRow> FindTrial(Connection& connection,
                                  std::string_view uuid) {
  Statement row(connection,
                "SELECT id, uuid, origin FROM trials WHERE uuid = ?");
  row.Add(uuid);
  if (!row.Step()) return std::nullopt;
  TrialRow found;
  found.row = row.TakeInteger();
  found.uuid = row.TakeText();
  found.origin = row.TakeText();
  return found;
}

std::optional<TrialRow> FindTrialOfClip(
    Connection& connection, std::optional<std::int64_t> campaign_row,
    std::int64_t clip_row) {
  Statement row(connection,
                "SELECT id, uuid, origin FROM trials "
                "WHERE ifnull(campaign_id, 0) = ? AND clip_id = ?");
  row.Add(campaign_row.value_or(0)).Add(clip_row);
  if (!row.Step()) return std::nullopt;
  TrialRow found;
  found.row = row.TakeInteger();
  found.uuid = row.TakeText();
  found.origin = row.TakeText();
  return found;
}

std::optional<std::int64_t> KeepClip(Connection& connection,
                                     const core::ClipIdentity& clip,
                                     std::string_view now_utc, Told told) {
  if (clip.id.empty()) return std::nullopt;
  // The same clip: the same cheap id (the size is part of what it digests; some
  // clips were logged without), and the same digest where both are known.
  // One whose digest agrees goes before one without. (Chosen here: ORDER BY
  // would make a temporary table for each clip.)
  std::optional<std::int64_t> known;
  bool agrees = false;
  {
    Statement find(
        connection,
        "SELECT id, sha256, size_bytes FROM clips WHERE clip_id = ?");
    find.Add(clip.id);
    while (find.Step()) {
      const std::int64_t id = find.TakeInteger();
      const auto sha256 = find.TakeOptionalText();
      const std::int64_t size = find.TakeInteger();
      if (size != clip.size_bytes && size != 0 && clip.size_bytes != 0)
        continue;
      if (sha256 && !clip.sha256.empty() && *sha256 != clip.sha256) continue;
      const bool better = sha256.has_value() && !agrees;
      if (!known || better || (sha256.has_value() == agrees && id < *known)) {
        known = id;
        agrees = sha256.has_value();
      }
    }
  }
  if (known) {
    if (told == Told::kHere) {
      Statement(connection,
                "UPDATE clips SET last_seen_path = ?, last_seen_at_utc = ? "
                "WHERE id = ?")
          .Add(clip.path)
          .Add(now_utc)
          .Add(*known)
          .Run();
    }
    Statement(connection,
              "UPDATE clips SET sha256 = ifnull(sha256, nullif(?, '')) "
              "WHERE id = ?")
        .Add(clip.sha256)
        .Add(*known)
        .Run();
    KeepClipLink(connection, *known);
    return known;
  }
  Statement(connection,
            "INSERT INTO clips (clip_id, size_bytes, sha256, last_seen_path, "
            "last_seen_at_utc) VALUES (?, ?, nullif(?, ''), ?, ?)")
      .Add(clip.id)
      .Add(clip.size_bytes)
      .Add(clip.sha256)
      .Add(clip.path)
      .Add(now_utc)
      .Run();
  const std::int64_t row = sqlite3_last_insert_rowid(connection.handle());
  KeepClipLink(connection, row);
  return row;
}

std::optional<std::int64_t> FindCampaignRow(Connection& connection,
                                            const core::Trial& trial) {
  if (trial.campaign.empty()) return std::nullopt;
  Statement row(
      connection,
      "SELECT id, body_kind, angle_kind FROM campaigns WHERE name = ?");
  row.Add(trial.campaign);
  if (!row.Step()) throw NoCampaign(connection, trial.campaign);
  const std::int64_t id = row.TakeInteger();
  const std::string body = row.TakeText();
  const std::string angle = row.TakeText();
  if (body != core::Name(trial.body.kind)) {
    throw std::invalid_argument(fmt::format(
        "body is a {}, but campaign '{}' is of a {}; choose another campaign",
        core::Name(trial.body.kind), trial.campaign, body));
  }
  if (angle != core::Name(trial.angle_kind)) {
    throw std::invalid_argument(
        fmt::format("angle kind is {}, but campaign '{}' varies the {} angle, "
                    "and kinds are "
                    "never pooled; choose another campaign",
                    core::Name(trial.angle_kind), trial.campaign, angle));
  }
  return id;
}

TrialRow AddTrial(Connection& connection, std::string_view uuid,
                  std::optional<std::int64_t> campaign_row, core::Origin origin,
                  std::optional<std::int64_t> clip_row,
                  std::string_view logged_at_utc) {
  Statement(connection,
            "INSERT INTO trials (uuid, campaign_id, clip_id, origin, "
            "logged_at_utc) VALUES (?, ?, ?, ?, ?)")
      .Add(uuid)
      .Add(campaign_row)
      .Add(clip_row)
      .Add(core::Name(origin))
      .Add(logged_at_utc)
      .Run();
  return {sqlite3_last_insert_rowid(connection.handle()), std::string(uuid),
          std::string(core::Name(origin))};
}

std::int64_t AddRevision(Connection& connection, std::int64_t trial_row,
                         const std::optional<Head>& head,
                         const NewRevision& revision,
                         const core::Trial& trial) {
  // A revision and its statement name each other, and the statement goes in
  // first, so the row is chosen here; the write lock is ours.
  const std::int64_t row =
      connection.Integer("SELECT ifnull(max(id), 0) + 1 FROM revisions");
  const std::int64_t number = head ? head->last_number + 1 : 1;
  const bool own_statement = revision.own_statement || !head;
  std::optional<std::int64_t> exclusion;
  if (!revision.own_exclusion && head) {
    exclusion = head->exclusion_id;
  } else if (trial.excluded) {
    exclusion = row;
  }
  std::optional<std::int64_t> conditions;
  if (head) conditions = head->conditions_id;
  if (revision.own_conditions) {
    conditions = KeepConditions(connection, row, trial.conditions, conditions);
  }
  if (own_statement) InsertStatement(connection, row, trial);
  if (exclusion == row) {
    Statement(connection,
              "INSERT INTO exclusions (revision_id, reason) VALUES (?, ?)")
        .Add(row)
        .Add(trial.exclusion_reason)
        .Run();
  }
  Statement(connection,
            "INSERT INTO revisions (id, uuid, trial_id, number, kind, "
            "statement_id, exclusion_id, author, reason, recorded_at_utc, "
            "conditions_id) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      .Add(row)
      .Add(revision.uuid)
      .Add(trial_row)
      .Add(number)
      .Add(Name(revision.kind))
      .Add(own_statement ? row : head->statement_id)
      .Add(exclusion)
      .Add(trial.author)
      .Add(trial.reason)
      .Add(revision.recorded_at_utc)
      .Add(conditions)
      .Run();
  KeepLink(connection, "revision", revision.uuid);
  return number;
}

std::vector<Revision> ReadHistory(Connection& connection,
                                  std::string_view uuid) {
  static const std::string sql =
      SelectRevisions(true) + "WHERE t.uuid = ? ORDER BY r.number";
  Statement row(connection, sql);
  row.Add(uuid);
  std::vector<Revision> history;
  while (row.Step()) {
    RevisionRow one = TakeRevision(connection, row);
    history.push_back(
        {std::move(one.uuid),
         ParseRevisionKind(one.kind).value_or(RevisionKind::kLogged),
         std::move(one.trial)});
  }
  return history;
}

void VisitHistories(
    Connection& connection,
    const std::function<void(const std::vector<Revision>&)>& visit) {
  Statement trials(connection, "SELECT uuid FROM trials ORDER BY id");
  while (trials.Step()) visit(ReadHistory(connection, trials.TakeText()));
}

}  // namespace touchdown::db
