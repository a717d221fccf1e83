// The parts of the schema, each a subject of its own.
#pragma once

#include <string>

namespace touchdown::db {

// The lab's register, and the conditions that refer to it.
std::string RegisterSql();

// The digests of trials and clips (digests.h).
std::string DigestsSql();

// Plans and looks (plan.h).
std::string PlanSql();
std::string PlanDigestsSql();

// What keeps evidence from being changed or removed.
std::string TriggersSql();

}  // namespace touchdown::db
