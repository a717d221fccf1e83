#include "touchdown/db/names.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "campaigns.h"
#include "register_rows.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/nearest.h"

namespace touchdown::db {

core::StoreError NoCampaign(Connection& connection, std::string_view name) {
  std::vector<std::string> names;
  Statement row(connection, "SELECT name FROM campaigns ORDER BY name");
  while (row.Step()) names.push_back(row.TakeText());
  return core::StoreError(fmt::format(
      "{}: there is no campaign '{}'; {}", connection.path().string(), name,
      core::DidYouMean(name, names,
                       "make it with `touchdown campaign new`, or see "
                       "`touchdown campaign list`")));
}

core::Campaign RequireCampaign(const Store& store, std::string_view name) {
  if (auto found = store.FindCampaign(name)) return *std::move(found);
  throw NoCampaign(store.connection(), name);
}

Entry RequireEntry(const Store& store, RegisterKind kind,
                   std::string_view name) {
  if (auto found = FindEntry(store, kind, name)) return *std::move(found);
  throw core::StoreError(
      fmt::format("{}: there is no {} '{}'; {}", store.path().string(),
                  Name(kind), name, NameMeant(store.connection(), kind, name)));
}

std::string NameMeant(Connection& connection, RegisterKind kind,
                      std::string_view name) {
  std::vector<std::string> names;
  Statement row(connection, fmt::format("SELECT DISTINCT name FROM {}",
                                        FindTable(kind).table));
  while (row.Step()) names.push_back(row.TakeText());
  return core::DidYouMean(name, names, "see `touchdown register list`");
}

}  // namespace touchdown::db
