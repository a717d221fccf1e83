// The parts of the schema, each a subject of its own.
#pragma once

#include <string>
#include <string_view>

namespace touchdown::db {

// The lab's register, and the conditions that refer to it.
std::string RegisterSql();

// The chain (chain.h).
std::string ChainSql();

// Plans and looks (plan.h).
std::string PlanSql();

// What people and other programs read (views.h).
std::string ViewsSql();
// The query of one of them, by name.
const std::string& ViewQuery(std::string_view view);

// What keeps evidence from being changed or removed.
std::string TriggersSql();

}  // namespace touchdown::db
