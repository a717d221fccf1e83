// What the commands of the store print.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/cli/messages.h"  // IWYU pragma: export: Printable
#include "touchdown/core/campaign.h"
#include "touchdown/core/estimate.h"

namespace touchdown::cli {

// "20.013 +- 0.048": u with two significant digits, the value to the same
// decimals, both divided by `unit`; "-" where absent.
std::string WithU(const core::Measured& measured, double unit);

// Columns aligned by character (UTF-8), two spaces between; the first row is
// the heading.
std::string Aligned(const std::vector<std::vector<std::string>>& rows);

// The conventions of a campaign, a line each.
std::string CampaignText(const core::Campaign& campaign);

}  // namespace touchdown::cli
