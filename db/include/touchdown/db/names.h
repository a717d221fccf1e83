// Campaigns and entries of the register by names that a person typed.
#pragma once

#include <string_view>

#include "touchdown/core/campaign.h"
#include "touchdown/db/register.h"
#include "touchdown/db/store.h"

namespace touchdown::db {

// Both throw core::StoreError where there is none of that name: with the name
// that may have been meant (core/nearest.h), or where to look.
core::Campaign RequireCampaign(const Store& store, std::string_view name);
Entry RequireEntry(const Store& store, RegisterKind kind,
                   std::string_view name);

}  // namespace touchdown::db
