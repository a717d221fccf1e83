// Core structs to rows and back.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "statement.h"
#include "touchdown/core/campaign.h"
#include "touchdown/core/trial.h"
#include "touchdown/db/records.h"

namespace touchdown::db {

// The statement of a revision: body, set-points, contacts, budgets, document.
void InsertStatement(Connection& connection, std::int64_t revision_id,
                     const core::Trial& trial);

// The five columns of a measured number: value, _u, _low, _high, _absent.
std::string MeasuredNames(std::string_view name);
void AddMeasured(Statement& statement, const core::Measured& measured);
core::Measured TakeMeasured(Statement& statement);
// "?, ?, ?": `count` of them, at least one.
std::string Placeholders(std::size_t count);

// Throws std::invalid_argument naming `field` if the value is NaN, u negative
// or the interval upside down.
void RequireMeasured(std::string_view field, const core::Measured& measured);

// For a person: "0.35 +- 0.001", "absent: not recorded"; "spring 3 (f81d4fae)",
// "none".
std::string MeasuredText(const core::Measured& measured);
std::string RegisteredText(const core::Registered& entry);

// Columns of a body, in the order in which AddBody and TakeBody go.
std::string BodyNames(std::string_view prefix);
void AddBody(Statement& statement, const core::Body& body);
core::Body TakeBody(Statement& statement);

// A query of trials: "SELECT <these> FROM <these>"; append WHERE and ORDER BY.
// t = trials, c = campaigns, k = clips, r = revisions (any number of a trial),
// s = statements in force, x = exclusions in force. A trial's contacts, budgets
// and conditions are fetched beside it.
std::string SelectRevisions(bool with_documents);

// The current revision of each trial that passes the filter. Parameters: the
// filter's fields that are set, in the order campaign, origin, body, state,
// from_utc, until_utc.
std::string TrialsSql(const TrialFilter& filter);

// The revision last logged of a clip in a campaign. Parameters: the campaign's
// name ("": none), the clip's id.
std::string_view LastLoggedSql();

// One row of SelectRevisions; contacts and budgets are fetched beside it.
struct RevisionRow {
  std::string uuid;
  std::string kind;
  core::Trial trial;
};
RevisionRow TakeRevision(Connection& connection, Statement& row);

}  // namespace touchdown::db
