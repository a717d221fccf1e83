#include "touchdown/rig/setpoints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "angles.h"
#include "throw_family.h"
#include "touchdown/core/require.h"
#include "touchdown/rig/flight.h"

namespace touchdown::rig {
namespace {

using core::AbsentBecause;
using core::AngleKind;
using core::Expected;

void ValidateWish(const ContactWish& wish) {
  core::RequirePositive("speed_mps", wish.speed_mps);
  const double low = wish.kind == AngleKind::kFace ? -kQuarterTurn : 0.0;
  if (!(wish.angle_rad >= low && wish.angle_rad <= kQuarterTurn)) {
    core::Refuse(
        "angle_deg", Deg(wish.angle_rad),
        wish.kind == AngleKind::kFace ? "within -90 .. 90" : "within 0 .. 90");
  }
  if (wish.muzzle_height_m) {
    core::RequireNotNegative("muzzle_height_m", *wish.muzzle_height_m);
  }
}

// The radius and face angles need a rectangle.
// The attitudes in which a corner stands at a radius angle: tilts up to the
// diagonal's, and beyond it. First those that land on the trailing corner.
std::vector<double> LandingAttitudes(double radius_rad, double least_rad) {
  const double tilt = std::fmax(0.0, radius_rad - least_rad);
  const double beyond = 2.0 * kQuarterTurn - least_rad - radius_rad;
  std::vector<double> out{tilt, -tilt};
  if (beyond <= kQuarterTurn + kAngleSlack_rad) {
    const double steep = std::fmin(beyond, kQuarterTurn);
    out.insert(out.end(), {-steep, steep});
  }
  return out;
}

// The first of the attitudes that the rig can do; else every reason.
Expected<Setting> FirstPossible(const Description& rig, const ContactWish& wish,
                                const std::vector<double>& faces_rad) {
  std::vector<std::string> reasons;
  for (const double face : faces_rad) {
    const auto corner = Land(rig.body->long_m->value, rig.body->short_m->value,
                             std::remainder(face, std::numbers::pi))
                            .corner;
    auto setting =
        wish.corner && corner != wish.corner
            ? Expected<Setting>(AbsentBecause(fmt::format(
                  "at a face angle of {:.2f} deg it is not the {} corner that "
                  "lands first",
                  Deg(face), core::Name(*wish.corner))))
            : BestThrow(rig, wish, AttitudeFamilies(rig, wish, face));
    if (setting) return setting;
    const std::string& reason = setting.error().reason;
    if (std::find(reasons.begin(), reasons.end(), reason) == reasons.end()) {
      reasons.push_back(reason);
    }
  }
  return AbsentBecause(fmt::format("{}", fmt::join(reasons, "; or ")));
}

}  // namespace

core::Expected<Setting> FindSetting(const Description& rig,
                                    const ContactWish& wish) {
  ValidateWish(wish);
  if (!ThrowsRectangle(rig)) {
    if (wish.kind != AngleKind::kApproach) {
      return AbsentBecause(fmt::format(
          "a sphere has no {} angle: the contact point is always straight "
          "below its centre",
          core::Name(wish.kind)));
    }
    if (wish.corner) return AbsentBecause("a sphere has no corners");
  }
  if (wish.kind == AngleKind::kApproach) {
    return BestThrow(rig, wish, ApproachFamilies(rig, wish));
  }
  if (wish.kind == AngleKind::kFace) {
    return FirstPossible(rig, wish, {wish.angle_rad});
  }
  // A corner cannot stand flatter than the diagonal of the body (E6).
  const double least =
      std::atan2(rig.body->short_m->value, rig.body->long_m->value);
  if (wish.angle_rad < least - kAngleSlack_rad) {
    return AbsentBecause(fmt::format(
        "the radius angle of this body is at least atan(short/long) = {:.2f} "
        "deg; {:.2f} deg needs short/long below {:.3g}",
        Deg(least), Deg(wish.angle_rad), std::tan(wish.angle_rad)));
  }
  return FirstPossible(rig, wish, LandingAttitudes(wish.angle_rad, least));
}

core::Expected<SetPoint> PlanContact(const Description& rig,
                                     const ContactWish& wish,
                                     const PredictOptions& options,
                                     std::mt19937_64& engine) {
  const auto setting = FindSetting(rig, wish);
  if (!setting) return AbsentBecause(setting.error().reason);
  return SetPoint{*setting, Predict(rig, *setting, options, engine)};
}

}  // namespace touchdown::rig
