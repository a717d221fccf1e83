#include "app/cli/store/store_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/cli/store/store_flags.h"
#include "app/text/format.h"
#include "touchdown/core/units.h"

namespace touchdown::cli {
namespace {

// Counts the characters of a UTF-8 text: its bytes but for those that continue
// one.
std::size_t Width(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U;
  }));
}

}  // namespace

std::string WithU(const core::Measured& measured, double unit) {
  if (!measured) return "-";
  // Without a usable u nothing says how many digits are meant; six are printed.
  if (!(measured->u > 0.0) || !std::isfinite(measured->u) ||
      !std::isfinite(measured->value)) {
    return fmt::format("{:.6g}", measured->value / unit);
  }
  return report::InAscii(report::WithU(*measured, unit));
}

std::string Aligned(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  // A row may have fewer cells than others.
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], Width(row[i]));
    }
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += row[i];
      line.append(widths[i] - Width(row[i]) + 2, ' ');
    }
    // The last column is not padded, so that lines have no blanks at their
    // ends.
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  }
  return text;
}

std::string CampaignText(const core::Campaign& campaign) {
  std::vector<std::vector<std::string>> rows = {
      {"campaign", Printable(campaign.name)},
      {"body", BodyText(campaign.body)},
      {"surface", campaign.surface.empty() ? "-" : Printable(campaign.surface)},
      {"varied angle", std::string(core::Name(campaign.angle_kind))},
      {"bounce height, mm",
       fmt::format("{:.4g}", campaign.bounce_height_m / core::kMillimetre)},
      {"speed, m/s",
       campaign.speed_max_mps > 0.0
           ? fmt::format("{:.4g} to {:.4g}", campaign.speed_min_mps,
                         campaign.speed_max_mps)
           : "not declared"}};
  // The theory and what it predicts stand in one line.
  std::string theory = "none declared";
  if (!campaign.theory_name.empty()) {
    theory = Printable(campaign.theory_name);
    if (campaign.theory_boundary_rad) {
      theory += fmt::format(", boundary {:.4g} deg",
                            *campaign.theory_boundary_rad / core::kDegree);
      if (campaign.theory_u_rad > 0.0) {
        theory +=
            fmt::format(" (u {:.2g})", campaign.theory_u_rad / core::kDegree);
      }
    }
  }
  rows.push_back({"theory", theory});
  rows.push_back({"margin, deg",
                  fmt::format("{:.4g}", campaign.margin_rad / core::kDegree)});
  return Aligned(rows);
}

}  // namespace touchdown::cli
