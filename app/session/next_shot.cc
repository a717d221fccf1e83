#include "app/session/next_shot.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <random>

#include "touchdown/core/units.h"

namespace touchdown::session {

using core::kDegree;
using core::kMillimetre;

core::Expected<rig::SetPoint> PlanNext(const Thrower& thrower,
                                       double angle_rad) {
  // Enough for u to 1 %, and short beside the fit.
  constexpr std::size_t kDraws = 10'000;
  rig::ContactWish wish = thrower.wish;
  wish.angle_rad = angle_rad;
  // The seed is fixed: asked again, the same angle gives the same numbers.
  std::mt19937_64 engine(1);
  return rig::PlanContact(thrower.rig, wish, {kDraws}, engine);
}

// `speed_mps` is the wished speed at touchdown, not that at the muzzle.
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

// The decimals are those that a person can set: 0.01 deg, 0.01 mm of
// compression and 0.1 mm of height.
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

}  // namespace touchdown::session
