// Campaigns as rows. Write functions belong inside a write transaction.
#pragma once

#include <optional>
#include <string_view>

#include "statement.h"
#include "touchdown/core/campaign.h"
#include "touchdown/core/errors.h"

namespace touchdown::db {

void InsertCampaign(Connection& connection, const core::Campaign& campaign,
                    std::string_view uuid, std::string_view now_utc);
std::optional<core::Campaign> SelectCampaign(Connection& connection,
                                             std::string_view name);

// The row of the surface of that name as it is in the register, entered where
// it is not there; nothing for no name.
std::optional<std::int64_t> KeepSurface(Connection& connection,
                                        std::string_view name,
                                        std::string_view uuid,
                                        std::string_view now_utc);

// To throw where there is no campaign of that name: with what may have been
// meant (names.cc).
core::StoreError NoCampaign(Connection& connection, std::string_view name);

// Equal in every convention.
bool SameConventions(const core::Campaign& a, const core::Campaign& b);

}  // namespace touchdown::db
