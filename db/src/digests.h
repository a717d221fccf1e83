// What shows that the evidence of a trial is what was recorded: one digest for
// each trial, made anew with each of its revisions.
//
//   D(0) = ""
//   D(n) = SHA-256("touchdown.trial/1\n" D(n-1) "\n" rows of revision n)
//
// The rows: trial, campaign with its surface, clip (id and size), revision,
// statement with its document and track, contacts, budgets, exclusion,
// conditions with the register entries that they name. A row is its table and
// each column that is not NULL: name, type, bytes. So a column that a later
// version of the schema adds, NULL in old rows, leaves old digests as they are.
//
// The plan and looks of a campaign (plan_events, in the order of their rows)
// have a digest of the same kind, one for each campaign.
//
// A seal over the store takes D of each trial, in the order of trials.id. A
// clip's SHA-256, which may be computed after the trial is logged, has a digest
// of its own.
//
// Write functions belong inside a write transaction.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "statement.h"

namespace touchdown::db {

// After revision `number` was added to the trial.
void KeepDigest(Connection& connection, std::int64_t trial_row,
                std::int64_t revision_row, std::int64_t number);

// After the clip's SHA-256 may have become known.
void KeepClipDigest(Connection& connection, std::int64_t clip_row);

// After an event, row `event_row` of plan_events, was added to the campaign.
void KeepPlanDigest(Connection& connection, std::int64_t campaign_row,
                    std::int64_t event_row);

// Of all trials and clips, and of all plans, in a store of a version that had
// none.
void KeepAllDigests(Connection& connection);
void KeepAllPlanDigests(Connection& connection);

// What does not agree with its digest, one line each.
void CheckDigests(Connection& connection, std::vector<std::string>& problems);

}  // namespace touchdown::db
