#include "touchdown/db/plan.h"

#include <fmt/format.h>

#include <stdexcept>

#include "campaigns.h"
#include "chain.h"
#include "plan_rows.h"
#include "statement.h"
#include "touchdown/db/store.h"

namespace touchdown::db {
namespace {

// In the order in which TakePlanEvent reads them.
constexpr std::string_view kColumns =
    "e.uuid, c.name, e.kind, e.design, e.stopping_rule, e.error_rates, "
    "e.trials, e.author, e.reason, e.at_utc";

PlanEvent TakePlanEvent(Statement& row) {
  PlanEvent event;
  event.id = row.TakeText();
  event.campaign = row.TakeText();
  event.kind =
      ParsePlanEventKind(row.TakeText()).value_or(PlanEventKind::kPlan);
  event.plan.design = row.TakeText();
  event.plan.stopping_rule = row.TakeText();
  event.plan.error_rates = row.TakeText();
  event.trials = row.TakeInteger();
  event.author = row.TakeText();
  event.reason = row.TakeText();
  event.at_utc = row.TakeText();
  return event;
}

std::int64_t CountCampaignTrials(Connection& connection,
                                 std::string_view campaign) {
  Statement row(connection,
                "SELECT count(*) FROM trials t JOIN campaigns c ON c.id = "
                "t.campaign_id WHERE c.name = ?");
  row.Add(campaign);
  return row.Step() ? row.TakeInteger() : 0;
}

}  // namespace

std::string_view Name(PlanEventKind kind) {
  return kind == PlanEventKind::kLook ? "look" : "plan";
}

std::optional<PlanEventKind> ParsePlanEventKind(std::string_view word) {
  for (const PlanEventKind kind :
       {PlanEventKind::kPlan, PlanEventKind::kLook}) {
    if (word == Name(kind)) return kind;
  }
  return std::nullopt;
}

std::vector<PlanEvent> ReadPlanEvents(Connection& connection,
                                      std::string_view campaign) {
  Statement row(connection,
                fmt::format("SELECT {} FROM plan_events e JOIN campaigns c ON "
                            "c.id = e.campaign_id WHERE ?1 = '' OR c.name = ?1 "
                            "ORDER BY e.at_utc, e.id",
                            kColumns));
  row.Add(campaign);
  std::vector<PlanEvent> out;
  while (row.Step()) out.push_back(TakePlanEvent(row));
  return out;
}

bool InsertPlanEvent(Connection& connection, const PlanEvent& event) {
  {
    Statement known(connection, "SELECT 1 FROM plan_events WHERE uuid = ?");
    known.Add(event.id);
    if (known.Step()) return false;
  }
  Statement(connection,
            "INSERT INTO plan_events (uuid, campaign_id, kind, design, "
            "stopping_rule, error_rates, trials, author, reason, at_utc) "
            "SELECT ?, id, ?, ?, ?, ?, ?, ?, ?, ? FROM campaigns WHERE name = "
            "?")
      .Add(event.id)
      .Add(Name(event.kind))
      .Add(event.plan.design)
      .Add(event.plan.stopping_rule)
      .Add(event.plan.error_rates)
      .Add(event.trials)
      .Add(event.author)
      .Add(event.reason)
      .Add(event.at_utc)
      .Add(event.campaign)
      .Run();
  // Nothing was added where there is no such campaign.
  if (sqlite3_changes(connection.handle()) == 0) return false;
  KeepLink(connection, "plan", event.id);
  return true;
}

void SetPlan(Store& store, std::string_view campaign, const Plan& plan,
             std::string_view author, std::string_view reason) {
  Connection& c = store.connection();
  Transaction transaction(c, Transaction::Kind::kWrite);
  if (!store.FindCampaign(campaign)) throw NoCampaign(c, campaign);
  const std::int64_t trials = CountCampaignTrials(c, campaign);
  bool first = true;
  for (const PlanEvent& event : ReadPlanEvents(c, campaign)) {
    first = first && event.kind != PlanEventKind::kPlan;
  }
  if (author.empty()) {
    throw std::invalid_argument("author is empty, must be who declares it");
  }
  if (trials > 0 && reason.empty()) {
    throw std::invalid_argument(
        fmt::format("reason is empty, must say why the plan of '{}' is {} "
                    "after trial {}",
                    campaign, first ? "declared" : "changed", trials));
  }
  InsertPlanEvent(c, {store.sources().new_uuid(), std::string(campaign),
                      PlanEventKind::kPlan, plan, trials, std::string(author),
                      std::string(reason), store.sources().now_utc()});
  transaction.Commit();
}

bool RecordLook(Store& store, std::string_view campaign,
                std::string_view author) {
  Connection& c = store.connection();
  Transaction transaction(c, Transaction::Kind::kWrite);
  if (!store.FindCampaign(campaign)) return false;
  const std::int64_t trials = CountCampaignTrials(c, campaign);
  if (trials == 0) return false;
  for (const PlanEvent& event : ReadPlanEvents(c, campaign)) {
    if (event.kind == PlanEventKind::kLook && event.trials == trials) {
      return false;
    }
  }
  InsertPlanEvent(c, {store.sources().new_uuid(),
                      std::string(campaign),
                      PlanEventKind::kLook,
                      {},
                      trials,
                      std::string(author),
                      "",
                      store.sources().now_utc()});
  transaction.Commit();
  return true;
}

std::vector<PlanEvent> PlanEvents(const Store& store,
                                  std::string_view campaign) {
  return ReadPlanEvents(store.connection(), campaign);
}

}  // namespace touchdown::db
