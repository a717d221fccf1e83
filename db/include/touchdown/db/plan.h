// The plan of a campaign on record: what was declared beside its conventions
// (core/campaign.h, which the store fixes before the first trial), each change
// of it, and each look at the answer. Events are added, never changed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace touchdown::db {

class Store;

enum class PlanEventKind {
  kPlan,  // the plan as it is from now on
  kLook   // somebody looked at the answer of the trials so far
};
std::string_view Name(PlanEventKind kind);
std::optional<PlanEventKind> ParsePlanEventKind(std::string_view word);

struct Plan {
  std::string design;         // how angles are chosen: "ascending 2 deg steps"
  std::string stopping_rule;  // when to stop: "after 40 trials"
  std::string error_rates;    // "false verdicts below 5 %, at every look"

  friend bool operator==(const Plan&, const Plan&) = default;
};

struct PlanEvent {
  std::string id;        // UUID
  std::string campaign;  // name
  PlanEventKind kind = PlanEventKind::kPlan;
  Plan plan;                // of kPlan
  std::int64_t trials = 0;  // logged in the campaign when it happened
  std::string author;       // person or command
  std::string reason;       // why the plan was changed; empty for the first
  std::string at_utc;       // ISO 8601, given by the store
};

// Declares the campaign's plan, or changes it; after the first trial with a
// reason. Throws core::StoreError where there is no
// such campaign, and std::invalid_argument where author or reason are missing.
void SetPlan(Store& store, std::string_view campaign, const Plan& plan,
             std::string_view author, std::string_view reason);

// Records that the answer was looked at. The same trials looked at again are no
// new look: true where this one was. A campaign without trials, or that is not
// there, has none.
bool RecordLook(Store& store, std::string_view campaign,
                std::string_view author);

// Every event of the campaigns, oldest first; of one where it is named.
std::vector<PlanEvent> PlanEvents(const Store& store,
                                  std::string_view campaign = "");

}  // namespace touchdown::db
