// Adding to a trial's chain of revisions. Call inside a write transaction.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "statement.h"
#include "touchdown/core/trial.h"
#include "touchdown/db/records.h"

namespace touchdown::db {

// The end of a trial's chain: the revision in force, and the number of the
// last, which may be a proposal.
struct Head {
  std::int64_t last_number = 0;
  std::int64_t number = 0;  // of the revision in force, as all that follows
  std::string uuid;
  std::int64_t statement_id = 0;
  std::optional<std::int64_t> exclusion_id;
  std::optional<std::int64_t> conditions_id;
};
std::optional<Head> FindHead(Connection& connection, std::int64_t trial_row);

// True if a person corrected the trial to what is in force now.
bool IsCorrected(Connection& connection, const Head& head);

struct TrialRow {
  std::int64_t row = 0;
  std::string uuid;
  std::string origin;
};
std::optional<TrialRow> FindTrial(Connection& connection,
                                  std::string_view uuid);
std::optional<TrialRow> FindTrialOfClip(
    Connection& connection, std::optional<std::int64_t> campaign_row,
    std::int64_t clip_row);

// The row of a clip, made or brought up to date (digest, where last seen);
// nothing for a trial without a clip. What another store tells of a clip that
// is known is no sight of it.
enum class Told { kHere, kElsewhere };
std::optional<std::int64_t> KeepClip(Connection& connection,
                                     const core::ClipIdentity& clip,
                                     std::string_view now_utc,
                                     Told told = Told::kHere);

// Row of the campaign; nothing for no campaign. Throws core::StoreError if
// there is none of that name, std::invalid_argument if the trial's body or
// angle kind is not the campaign's.
std::optional<std::int64_t> FindCampaignRow(Connection& connection,
                                            const core::Trial& trial);

TrialRow AddTrial(Connection& connection, std::string_view uuid,
                  std::optional<std::int64_t> campaign_row, core::Origin origin,
                  std::optional<std::int64_t> clip_row,
                  std::string_view logged_at_utc);

// What a new revision states of its own; the rest stays as in the head.
struct NewRevision {
  std::string uuid;
  RevisionKind kind = RevisionKind::kLogged;
  std::string recorded_at_utc;
  bool own_statement = true;
  // Exclusion of `trial` as it is; else the head's stays in force.
  bool own_exclusion = true;
  // Conditions of `trial` as they are; else the head's stay in force.
  bool own_conditions = true;
};

// Adds the next revision; author and reason are `trial`'s.
// Returns its number.
std::int64_t AddRevision(Connection& connection, std::int64_t trial_row,
                         const std::optional<Head>& head,
                         const NewRevision& revision, const core::Trial& trial);

// Every revision of a trial, oldest first.
std::vector<Revision> ReadHistory(Connection& connection,
                                  std::string_view uuid);
// The histories of all trials, in the order in which they were logged.
void VisitHistories(
    Connection& connection,
    const std::function<void(const std::vector<Revision>&)>& visit);

}  // namespace touchdown::db
