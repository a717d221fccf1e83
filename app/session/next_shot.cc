#include "app/session/next_shot.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <random>
#include <stdexcept>

#include "app/pipeline/rig_reach.h"
#include "touchdown/core/units.h"

namespace touchdown::session {

using core::kDegree;
using core::kMillimetre;

Thrower MakeThrower(const std::filesystem::path& rig_file,
                    const core::Campaign& campaign, double speed_mps,
                    std::optional<core::Corner> corner) {
  Thrower out;
  out.file = rig_file.string();
  out.rig = rig::ReadDescription(rig_file);
  if (out.rig.body && out.rig.body->kind != campaign.body.kind) {
    throw std::invalid_argument(fmt::format(
        "--rig: the body of {} is a {}, the trials are of a {}", out.file,
        core::Name(out.rig.body->kind), core::Name(campaign.body.kind)));
  }
  out.wish.kind = campaign.angle_kind;
  out.wish.corner = corner;
  out.wish.speed_mps =
      speed_mps > 0.0 ? speed_mps
                      : (campaign.speed_min_mps + campaign.speed_max_mps) / 2;
  if (!(out.wish.speed_mps > 0.0)) {
    throw std::invalid_argument(
        "--rig: needs --speed-mps, the speed at touchdown: the campaign "
        "declares no speed band");
  }
  return out;
}

core::Interval RequireReach(const Thrower& thrower) {
  const auto reach = pipeline::ReachableAngles(thrower.rig, thrower.wish);
  if (reach) return *reach;
  throw std::invalid_argument(
      fmt::format("--rig: {} cannot throw any {} angle at {:g} m/s: {}",
                  thrower.file, core::Name(thrower.wish.kind),
                  thrower.wish.speed_mps, reach.error().reason));
}

core::Expected<rig::SetPoint> PlanNext(const Thrower& thrower,
                                       double angle_rad) {
  // Enough for u to 1 %, and short beside the fit.
  constexpr std::size_t kDraws = 10'000;
  rig::ContactWish wish = thrower.wish;
  wish.angle_rad = angle_rad;
  std::mt19937_64 engine(1);
  return rig::PlanContact(thrower.rig, wish, {kDraws}, engine);
}

nlohmann::ordered_json SetPointsJson(
    const Thrower& thrower, const core::Expected<rig::SetPoint>& point) {
  nlohmann::ordered_json out = {
      {"rig", thrower.rig.name},
      {"speed_mps", thrower.wish.speed_mps},
      {"possible", point.has_value()},
      {"reason", point ? nlohmann::ordered_json(nullptr)
                       : nlohmann::ordered_json(point.error().reason)}};
  if (point) {
    out["elevation_deg"] = point->setting.elevation_rad / kDegree;
    out["compression_mm"] = point->setting.compression_m / kMillimetre;
    out["muzzle_height_mm"] = point->setting.muzzle_height_m / kMillimetre;
  }
  return out;
}

std::string SetPointsText(const Thrower& thrower,
                          const core::Expected<rig::SetPoint>& point) {
  if (!point) return "none: " + point.error().reason;
  return fmt::format(
      "elevation {:.2f} deg, compression {:.2f} mm, muzzle height {:.1f} mm "
      "({}, {:g} m/s at touchdown)",
      point->setting.elevation_rad / kDegree,
      point->setting.compression_m / kMillimetre,
      point->setting.muzzle_height_m / kMillimetre,
      thrower.rig.name.empty() ? "the rig" : thrower.rig.name,
      thrower.wish.speed_mps);
}

report::Group EmptyGroup(const core::Campaign& campaign,
                         const analysis::StudyOptions& study) {
  report::Group group;
  group.campaign = campaign;
  group.prior = study.fit.scatter;
  group.study = analysis::StudyBoundary({}, study);
  return group;
}

}  // namespace touchdown::session
