// The plan on record: declared, changed or not, looks and exclusions.
#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <vector>

#include "app/report/content.h"
#include "app/report/set_points.h"
#include "app/text/format.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;

// "before the first trial" or "after trial 12": only the first is a declaration
// in advance.
std::string DescribeInstant(std::int64_t trials) {
  return trials == 0 ? "before the first trial"
                     : fmt::format("after trial {}", trials);
}

// One field of the plan through its changes: "declared before the first trial
// (2026-08-01T09:12:00Z, weber): X; changed after trial 12 (...): Y, because
// Z". Events that leave the field as it is say nothing of it.
std::string History(const std::vector<const db::PlanEvent*>& plans,
                    std::string db::Plan::*field) {
  std::string out;
  std::string said;
  for (const db::PlanEvent* event : plans) {
    const std::string& now = event->plan.*field;
    if (now == said) continue;
    out += fmt::format("{}{} {} ({}, {}): {}", out.empty() ? "" : "; ",
                       said.empty() ? "declared" : "changed",
                       DescribeInstant(event->trials), event->at_utc,
                       event->author, now.empty() ? "withdrawn" : now);
    if (!event->reason.empty()) out += ", because " + event->reason;
    said = now;
  }
  return out.empty() ? "not declared" : out;
}

}  // namespace

std::vector<Block> MakePlan(const Group& group,
                            std::span<const core::Trial> trials,
                            const ReportInput& input) {
  // Only a campaign of a store has a plan on record.
  if (!group.registered) return {};
  std::vector<const db::PlanEvent*> plans;
  std::vector<const db::PlanEvent*> looks;
  for (const db::PlanEvent& event : input.plan) {
    if (event.campaign != group.campaign.name) continue;
    (event.kind == db::PlanEventKind::kLook ? looks : plans).push_back(&event);
  }
  Table table{"The plan on record", {{"what"}, {"when, and by whom"}}, {}};
  const auto row = [&](const char* name, std::string value) {
    table.rows.push_back({{name}, {std::move(value)}});
  };
  // The store fixes theory and margin with the campaign, before the first
  // trial; the other entries are events that may follow.
  const core::Campaign& c = group.campaign;
  row("theory and margin",
      c.theory_boundary_rad
          ? fmt::format(
                "declared before the first trial, and fixed since: {} "
                "deg, margin {} deg",
                WithU({*c.theory_boundary_rad, c.theory_u_rad, {}}, kDegree),
                Plain(c.margin_rad / kDegree))
          : "not declared");
  row("error rates", History(plans, &db::Plan::error_rates));
  row("design", History(plans, &db::Plan::design));
  row("stopping rule", History(plans, &db::Plan::stopping_rule));
  // A reader may ask how often the answer was seen before the trials ended.
  if (looks.empty()) {
    row("looks at the answer", "none on record");
  } else {
    std::string when;
    for (const db::PlanEvent* look : looks) {
      when += fmt::format("{}{} ({}, {})", when.empty() ? "" : "; ",
                          DescribeInstant(look->trials), look->at_utc,
                          look->author);
    }
    row("looks at the answer", when);
  }
  // An exclusion after the answer was seen is the easiest way to a wanted
  // answer: each is shown with its reason, time and author.
  std::string excluded;
  for (const std::size_t i : group.members) {
    const core::Trial& trial = trials[i];
    if (!trial.excluded) continue;
    excluded += fmt::format("{}{}: {} ({}, {})", excluded.empty() ? "" : "; ",
                            TrialName(trial), trial.exclusion_reason,
                            trial.recorded_at_utc, trial.author);
  }
  row("exclusions", excluded.empty() ? "none" : excluded);
  return {std::move(table)};
}

}  // namespace touchdown::report
