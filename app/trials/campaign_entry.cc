#include "app/trials/campaign_entry.h"

#include <fmt/format.h>

#include <charconv>
#include <tuple>
#include <utility>

#include "app/trials/statement.h"
#include "app/trials/typed_values.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

using core::kDegree;
using core::kMillimetre;

// "3.5:4.5"
// Reads a campaign's speed band at touchdown, in m/s: lowest, then highest.
// Only the form is checked here; db::RequireStorable refuses a band that is
// upside down or negative. Throws FieldError naming speed-mps.
std::pair<double, double> ParseBand(const std::string& text) {
  std::pair<double, double> band;
  const char* const end = text.data() + text.size();
  const auto low = std::from_chars(text.data(), end, band.first);
  if (low.ec == std::errc() && low.ptr != end && *low.ptr == ':') {
    const auto high = std::from_chars(low.ptr + 1, end, band.second);
    if (high.ec == std::errc() && high.ptr == end) return band;
  }
  throw FieldError("speed-mps",
                   fmt::format("is '{}', must be like 3.5:4.5", text));
}

}  // namespace

std::optional<core::Body> ParseBody(const BodyEntry& entry) {
  if (entry.kind.empty() && entry.diameter_mm.empty() &&
      entry.sides_mm.empty()) {
    return std::nullopt;
  }
  // Without a kind the size tells it: sides are a rectangle's.
  core::BodyKind kind = entry.sides_mm.empty() ? core::BodyKind::kSphere
                                               : core::BodyKind::kRectangle;
  if (!entry.kind.empty()) {
    const auto word = core::ParseBodyKind(entry.kind);
    if (!word) {
      throw FieldError("body", fmt::format("is '{}', must be sphere or "
                                           "rectangle",
                                           entry.kind));
    }
    kind = *word;
  }
  if (kind == core::BodyKind::kSphere) {
    if (!entry.sides_mm.empty()) {
      throw FieldError("sides-mm",
                       "is given, but a sphere has a --diameter-mm");
    }
    if (entry.diameter_mm.empty()) {
      // A body whose size nobody gave is a body all the same: a trial by hand
      // can be logged without it.
      return core::UnmeasuredBody(core::BodyKind::kSphere);
    }
    return core::Sphere(ParseEstimateField("diameter-mm", entry.diameter_mm,
                                           kMillimetre, kPlainSize));
  }
  if (!entry.diameter_mm.empty()) {
    throw FieldError("diameter-mm", "is given, but a rectangle has --sides-mm");
  }
  if (entry.sides_mm.empty()) {
    return core::UnmeasuredBody(core::BodyKind::kRectangle);
  }
  const auto [a, b] =
      ParseSidesField("sides-mm", entry.sides_mm, kMillimetre, kPlainSize);
  return core::Rectangle(a, b);
}

core::Campaign MakeCampaign(const CampaignEntry& entry) {
  core::Campaign campaign;
  campaign.name = entry.name;
  // A campaign cannot do without a body; a trial can (ParseBody).
  const auto body = ParseBody(entry.body);
  if (!body) {
    throw FieldError("body",
                     "is missing, must be sphere (with --diameter-mm) or "
                     "rectangle (with --sides-mm)");
  }
  campaign.body = *body;
  campaign.surface = entry.surface;
  campaign.angle_kind = core::DefaultAngleKind(body->kind);
  if (!entry.angle_kind.empty()) {
    const auto kind = core::ParseAngleKind(entry.angle_kind);
    if (!kind) {
      throw FieldError("angle-kind",
                       fmt::format("is '{}', must be approach, radius or face",
                                   entry.angle_kind));
    }
    campaign.angle_kind = *kind;
  }
  // The bounce height is fixed before the first trial. The default convention
  // needs the size, so a body without one must come with a stated height.
  if (entry.bounce_height_mm) {
    campaign.bounce_height_m = *entry.bounce_height_mm * kMillimetre;
  } else {
    const auto size = core::Size(*body);
    if (!size) {
      throw FieldError("bounce-height-mm",
                       "is missing, and without the body's size it has no "
                       "default");
    }
    campaign.bounce_height_m = core::DefaultBounceHeight(size->value);
  }
  // No band: both ends stay 0, which means "not declared".
  if (!entry.speed_mps.empty()) {
    std::tie(campaign.speed_min_mps, campaign.speed_max_mps) =
        ParseBand(entry.speed_mps);
  }
  campaign.theory_name = entry.theory;
  if (entry.theory_boundary_deg) {
    campaign.theory_boundary_rad = *entry.theory_boundary_deg * kDegree;
  }
  if (entry.theory_u_deg) campaign.theory_u_rad = *entry.theory_u_deg * kDegree;
  campaign.margin_rad = entry.margin_deg * kDegree;
  return campaign;
}

}  // namespace touchdown::pipeline
