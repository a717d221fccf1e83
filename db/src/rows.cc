#include "rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "register_rows.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/quantities.h"

namespace touchdown::db {
namespace {

using core::AbsentBecause;
using core::Budget;
using core::ContactRecord;
using core::Estimate;
using core::Interval;
using core::Measured;

[[noreturn]] void Refuse(std::string_view field, double value,
                         std::string_view must) {
  throw std::invalid_argument(
      fmt::format("{} is {}, must be {}", field, value, must));
}

void RequireNumber(std::string_view field, double value) {
  if (std::isnan(value)) {
    Refuse(field, value, "a number, or absent with a reason");
  }
}

}  // namespace

void AddMeasured(Statement& statement, const Measured& measured) {
  if (!measured) {
    statement.Add(std::nullopt)
        .Add(std::nullopt)
        .Add(std::nullopt)
        .Add(std::nullopt)
        .Add(measured.error().reason);
    return;
  }
  statement.Add(measured->value).Add(measured->u);
  if (measured->interval95) {
    statement.Add(measured->interval95->low).Add(measured->interval95->high);
  } else {
    statement.Add(std::nullopt).Add(std::nullopt);
  }
  statement.Add(std::nullopt);
}

Measured TakeMeasured(Statement& statement) {
  if (statement.NextIsNull()) {
    statement.Skip(4);
    // NULL: of a row that is older than the column.
    return AbsentBecause(
        statement.TakeOptionalText().value_or("logged before it was recorded"));
  }
  Estimate estimate;
  estimate.value = statement.TakeReal();
  estimate.u = statement.TakeReal();
  const auto low = statement.TakeOptionalReal();
  const auto high = statement.TakeOptionalReal();
  if (low && high) estimate.interval95 = Interval{*low, *high};
  statement.Skip(1);
  return estimate;
}

std::string Placeholders(std::size_t count) {
  std::string text = "?";
  for (std::size_t i = 1; i < count; ++i) text += ", ?";
  return text;
}

void RequireMeasured(std::string_view field, const Measured& measured) {
  if (!measured) return;
  RequireNumber(field, measured->value);
  if (!(measured->u >= 0.0)) {
    Refuse(fmt::format("u of {}", field), measured->u, "at least 0");
  }
  if (measured->interval95 &&
      !(measured->interval95->low <= measured->interval95->high)) {
    Refuse(fmt::format("lower end of the interval of {}", field),
           measured->interval95->low,
           fmt::format("at most its upper end {}", measured->interval95->high));
  }
}

namespace {

// A word of a coded column; the file's CHECK lets no other in.
template <class T>
T KnownWord(std::optional<T> parsed, const Connection& connection) {
  if (!parsed) {
    throw core::StoreError(fmt::format(
        "{}: the trial store holds a word this program does not know; see "
        "`touchdown db check`",
        connection.path().string()));
  }
  return *parsed;
}

const std::string& ContactNames() {
  static const std::string names = [] {
    std::string text =
        "found, not_found_because, from_start, corner, state, p_bounce, "
        "state_because, micro_bounce";
    for (const auto& quantity : core::kContactQuantities) {
      text += ", " + MeasuredNames(quantity.name);
    }
    return text;
  }();
  return names;
}
// Eight of the contact itself, five for each quantity (value, u, interval,
// reason).
constexpr std::size_t kContactColumns = 8 + 5 * core::kContactQuantities.size();

void InsertBudgets(Connection& connection, std::int64_t revision_id,
                   std::int64_t ordinal, const core::Contact& contact) {
  // One row at a time: with several in one VALUES, SQLite makes a temporary
  // table first, because of the triggers.
  Statement insert(connection,
                   "INSERT INTO budget_lines (revision_id, ordinal, budget, "
                   "line, source, u_rad) VALUES (?, ?, ?, ?, ?, ?)");
  for (const auto& budget : core::kBudgets) {
    const Budget& lines = contact.*budget.member;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      insert.Add(revision_id)
          .Add(ordinal)
          .Add(budget.name)
          .Add(static_cast<std::int64_t>(i))
          .Add(lines[i].source)
          .Add(lines[i].u)
          .Run();
    }
  }
}

void InsertContact(Connection& connection, std::int64_t revision_id,
                   std::int64_t ordinal, const ContactRecord& record) {
  static const std::string sql =
      fmt::format("INSERT INTO contacts (revision_id, ordinal, {}) VALUES ({})",
                  ContactNames(), Placeholders(2 + kContactColumns));
  Statement insert(connection, sql);
  insert.Add(revision_id)
      .Add(ordinal)
      .Add(record.contact.found)
      .Add(record.contact.reason)
      .Add(record.contact.from_start);
  if (record.contact.corner) {
    insert.Add(core::Name(*record.contact.corner));
  } else {
    insert.Add(std::nullopt);
  }
  insert.Add(core::Name(record.state.label))
      .Add(record.state.p_bounce)
      .Add(record.state.reason)
      .Add(record.state.micro_bounce);
  for (const auto& quantity : core::kContactQuantities) {
    AddMeasured(insert, At(record, quantity));
  }
  insert.Run();
  InsertBudgets(connection, revision_id, ordinal, record.contact);
}

ContactRecord TakeContact(Connection& connection, Statement& row) {
  ContactRecord record;
  record.contact.found = row.TakeBool();
  record.contact.reason = row.TakeText();
  record.contact.from_start = row.TakeBool();
  if (const auto corner = row.TakeOptionalText()) {
    record.contact.corner = KnownWord(core::ParseCorner(*corner), connection);
  }
  record.state.label =
      KnownWord(core::ParseMotionState(row.TakeText()), connection);
  record.state.p_bounce = row.TakeOptionalReal();
  record.state.reason = row.TakeText();
  record.state.micro_bounce = row.TakeBool();
  for (const auto& quantity : core::kContactQuantities) {
    At(record, quantity) = TakeMeasured(row);
  }
  return record;
}

// --- what may not enter ------------------------------------------------------

void RequireBody(const core::Body& body) {
  for (const auto& quantity : core::kBodyQuantities) {
    RequireMeasured(fmt::format("body.{}", quantity.name),
                    body.*quantity.member);
  }
}

void RequireContact(const ContactRecord& record) {
  for (const auto& quantity : core::kContactQuantities) {
    RequireMeasured(quantity.name, At(record, quantity));
  }
  if (record.state.p_bounce) {
    const double p = *record.state.p_bounce;
    if (!(p >= 0.0 && p <= 1.0)) Refuse("p_bounce", p, "in [0, 1]");
  }
  for (const auto& budget : core::kBudgets) {
    for (const auto& line : record.contact.*budget.member) {
      if (!(line.u >= 0.0)) {
        Refuse(fmt::format("u of the {} budget's line '{}'", budget.name,
                           line.source),
               line.u, "at least 0");
      }
    }
  }
}

void RequireRange(std::string_view field, double value, double low,
                  std::string_view must) {
  if (!(value >= low) || !std::isfinite(value)) Refuse(field, value, must);
}

}  // namespace

void RequireStorable(const core::Trial& trial) {
  RequireBody(trial.body);
  RequireContact(trial.first);
  for (const auto& record : trial.later) RequireContact(record);
  if (trial.conditions) RequireStorable(*trial.conditions);
  if (trial.set_angle_rad) RequireNumber("set_angle_rad", *trial.set_angle_rad);
  if (trial.set_speed_mps) RequireNumber("set_speed_mps", *trial.set_speed_mps);
  if (trial.clip.size_bytes < 0) {
    throw std::invalid_argument(fmt::format(
        "clip.size_bytes is {}, must be at least 0", trial.clip.size_bytes));
  }
  if (trial.clip.id.empty() &&
      !(trial.clip.path.empty() && trial.clip.sha256.empty() &&
        trial.clip.size_bytes == 0)) {
    throw std::invalid_argument(fmt::format(
        "clip.id is empty, but the trial has a clip ('{}'): a clip is known by "
        "its id",
        trial.clip.path));
  }
  if (trial.author.empty()) {
    throw std::invalid_argument(
        "author is empty, must say which program or person states this");
  }
}

void RequireStorable(const core::Campaign& campaign) {
  if (campaign.name.empty()) {
    throw std::invalid_argument("campaign name is empty, must be a name");
  }
  RequireBody(campaign.body);
  if (!(campaign.bounce_height_m > 0.0)) {
    Refuse("bounce_height_m", campaign.bounce_height_m,
           "above 0 and finite: rising above it is what bounce means");
  }
  RequireRange("bounce_height_m", campaign.bounce_height_m, 0.0, "finite");
  RequireRange("speed_min_mps", campaign.speed_min_mps, 0.0,
               "at least 0 and finite");
  RequireRange("speed_max_mps", campaign.speed_max_mps, campaign.speed_min_mps,
               "at least speed_min_mps and finite");
  if (!(campaign.margin_rad > 0.0)) {
    Refuse("margin_rad", campaign.margin_rad, "above 0");
  }
  RequireRange("margin_rad", campaign.margin_rad, 0.0, "finite");
  RequireRange("theory_u_rad", campaign.theory_u_rad, 0.0,
               "at least 0 and finite");
  if (campaign.theory_boundary_rad) {
    RequireRange("theory_boundary_rad", *campaign.theory_boundary_rad, 0.0,
                 "at least 0 and finite");
    if (campaign.theory_name.empty()) {
      throw std::invalid_argument(
          "theory_name is empty, but a boundary was given: the theory needs a "
          "name");
    }
  }
}

std::string MeasuredNames(std::string_view name) {
  return fmt::format("{0}, {0}_u, {0}_low, {0}_high, {0}_absent", name);
}

std::string BodyNames(std::string_view prefix) {
  std::string text = fmt::format("{}body_kind", prefix);
  for (const auto& quantity : core::kBodyQuantities) {
    text += ", " + MeasuredNames(fmt::format("{}{}", prefix, quantity.name));
  }
  return text;
}

void AddBody(Statement& statement, const core::Body& body) {
  statement.Add(core::Name(body.kind));
  for (const auto& quantity : core::kBodyQuantities) {
    AddMeasured(statement, body.*quantity.member);
  }
}

core::Body TakeBody(Statement& statement) {
  core::Body body;
  // The column's CHECK allows these two words only.
  body.kind = core::ParseBodyKind(statement.TakeText())
                  .value_or(core::BodyKind::kSphere);
  for (const auto& quantity : core::kBodyQuantities) {
    body.*quantity.member = TakeMeasured(statement);
  }
  return body;
}

void InsertStatement(Connection& connection, std::int64_t revision_id,
                     const core::Trial& trial) {
  static const std::string sql = fmt::format(
      "INSERT INTO statements (revision_id, clip_path, angle_kind, {}, "
      "set_angle_rad, set_speed_mps, contacts, software_version, options_hash, "
      "document_json) VALUES ({})",
      BodyNames(""), Placeholders(10 + 5 * core::kBodyQuantities.size()));
  Statement insert(connection, sql);
  insert.Add(revision_id)
      .Add(trial.clip.path)
      .Add(core::Name(trial.angle_kind));
  AddBody(insert, trial.body);
  insert.Add(trial.set_angle_rad)
      .Add(trial.set_speed_mps)
      .Add(static_cast<std::int64_t>(1 + trial.later.size()))
      .Add(trial.software_version)
      .Add(trial.options_hash)
      .Add(trial.document_json);
  insert.Run();
  InsertContact(connection, revision_id, 0, trial.first);
  for (std::size_t i = 0; i < trial.later.size(); ++i) {
    InsertContact(connection, revision_id, static_cast<std::int64_t>(i + 1),
                  trial.later[i]);
  }
}

std::string SelectRevisions(bool with_documents) {
  return fmt::format(
      "SELECT r.uuid, r.kind, r.statement_id, t.uuid, ifnull(c.name, ''), "
      "t.origin, ifnull(k.last_seen_path, s.clip_path), ifnull(k.clip_id, ''), "
      "ifnull(k.sha256, ''), "
      "ifnull(k.size_bytes, 0), s.angle_kind, {}, s.set_angle_rad, "
      "s.set_speed_mps, r.conditions_id, r.number, r.author, r.reason, "
      "r.recorded_at_utc, "
      "s.software_version, s.options_hash, r.exclusion_id IS NOT NULL, "
      "ifnull(x.reason, ''), {} "
      "FROM trials t "
      "JOIN revisions r ON r.trial_id = t.id "
      "JOIN statements s ON s.revision_id = r.statement_id "
      "LEFT JOIN campaigns c ON c.id = t.campaign_id "
      "LEFT JOIN clips k ON k.id = t.clip_id "
      "LEFT JOIN exclusions x ON x.revision_id = r.exclusion_id ",
      BodyNames("s."), with_documents ? "s.document_json" : "''");
}

std::string TrialsSql(const TrialFilter& filter) {
  std::string sql = SelectRevisions(filter.with_documents);
  if (filter.state) {
    sql +=
        "JOIN contacts f ON f.revision_id = s.revision_id AND f.ordinal = 0 ";
  }
  sql +=
      "WHERE r.number = (SELECT max(number) FROM revisions "
      "WHERE trial_id = t.id AND kind <> 'proposed')";
  if (filter.campaign) {
    sql +=
        " AND ifnull(t.campaign_id, 0) = ifnull((SELECT id FROM campaigns "
        "WHERE name = ?), 0)";
  }
  if (filter.origin) sql += " AND t.origin = ?";
  if (filter.body) sql += " AND s.body_kind = ?";
  if (filter.state) sql += " AND f.state = ?";
  if (filter.from_utc) sql += " AND t.logged_at_utc >= ?";
  if (filter.until_utc) sql += " AND t.logged_at_utc < ?";
  if (filter.excluded) {
    sql += *filter.excluded ? " AND r.exclusion_id IS NOT NULL"
                            : " AND r.exclusion_id IS NULL";
  }
  return sql + " ORDER BY t.id";
}

std::string_view LastLoggedSql() {
  return "SELECT t.uuid, s.options_hash, s.set_angle_rad, s.set_speed_mps "
         "FROM clips k JOIN trials t ON t.clip_id = k.id "
         "AND ifnull(t.campaign_id, 0) = "
         "ifnull((SELECT id FROM campaigns WHERE name = ?1), 0) "
         "JOIN revisions r ON r.trial_id = t.id "
         "AND (r.kind = 'logged' OR r.kind = 'proposed') "
         "JOIN statements s ON s.revision_id = r.statement_id "
         "WHERE k.clip_id = ?2 ORDER BY t.id DESC, r.number DESC LIMIT 1";
}

RevisionRow TakeRevision(Connection& connection, Statement& row) {
  RevisionRow out;
  core::Trial& trial = out.trial;
  out.uuid = row.TakeText();
  out.kind = row.TakeText();
  const std::int64_t statement_id = row.TakeInteger();
  trial.id = row.TakeText();
  trial.campaign = row.TakeText();
  trial.origin = KnownWord(core::ParseOrigin(row.TakeText()), connection);
  trial.clip.path = row.TakeText();
  trial.clip.id = row.TakeText();
  trial.clip.sha256 = row.TakeText();
  trial.clip.size_bytes = row.TakeInteger();
  trial.angle_kind =
      KnownWord(core::ParseAngleKind(row.TakeText()), connection);
  trial.body = TakeBody(row);
  trial.set_angle_rad = row.TakeOptionalReal();
  trial.set_speed_mps = row.TakeOptionalReal();
  if (const auto conditions = row.TakeOptionalInteger()) {
    trial.conditions = SelectConditions(connection, *conditions);
  }
  trial.revision = row.TakeInteger();
  trial.author = row.TakeText();
  trial.reason = row.TakeText();
  trial.recorded_at_utc = row.TakeText();
  trial.software_version = row.TakeText();
  trial.options_hash = row.TakeText();
  trial.excluded = row.TakeBool();
  trial.exclusion_reason = row.TakeText();
  trial.document_json = row.TakeText();

  static const std::string contacts_sql = fmt::format(
      "SELECT {} FROM contacts WHERE revision_id = ? ORDER BY ordinal",
      ContactNames());
  Statement contacts(connection, contacts_sql);
  contacts.Add(statement_id);
  if (contacts.Step()) trial.first = TakeContact(connection, contacts);
  while (contacts.Step()) {
    trial.later.push_back(TakeContact(connection, contacts));
  }
  Statement lines(connection,
                  "SELECT ordinal, budget, source, u_rad FROM budget_lines "
                  "WHERE revision_id = ? ORDER BY ordinal, budget, line");
  lines.Add(statement_id);
  while (lines.Step()) {
    const auto ordinal = static_cast<std::size_t>(lines.TakeInteger());
    if (ordinal > trial.later.size()) continue;
    core::Contact& contact =
        ordinal == 0 ? trial.first.contact : trial.later[ordinal - 1].contact;
    const std::string which = lines.TakeText();
    core::BudgetLine line;
    line.source = lines.TakeText();
    line.u = lines.TakeReal();
    for (const auto& budget : core::kBudgets) {
      if (budget.name == which) {
        (contact.*budget.member).push_back(std::move(line));
        break;
      }
    }
  }
  return out;
}

}  // namespace touchdown::db
