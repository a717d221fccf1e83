// Plans and looks as rows. Write functions belong inside a write transaction.
#pragma once

#include <string_view>
#include <vector>

#include "statement.h"
#include "touchdown/db/plan.h"

namespace touchdown::db {

std::vector<PlanEvent> ReadPlanEvents(Connection& connection,
                                      std::string_view campaign);

// As it is, id and date too, with its link of the chain, but for one whose id
// is there already or whose campaign is not; false then.
bool InsertPlanEvent(Connection& connection, const PlanEvent& event);

}  // namespace touchdown::db
