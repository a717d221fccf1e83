#include "touchdown/rig/setpoints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "require.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/flight.h"

namespace touchdown::rig {
namespace {

using core::AbsentBecause;
using core::AngleKind;
using core::Expected;

constexpr double kQuarterTurn = std::numbers::pi / 2.0;
constexpr double kAngleSlack_rad = 1e-9;  // rounding at limits given in degrees
constexpr double kLengthSlack_m = 1e-9;
constexpr int kIterations = 200;

double Deg(double rad) { return rad / core::kDegree; }
double Mm(double m) { return m / core::kMillimetre; }

// A throw that would give the wish, before the springs are asked.
struct Throw {
  double elevation_rad = 0.0;
  double muzzle_height_m = 0.0;
  double launch_speed_mps = 0.0;
};

void Validate(const ContactWish& wish) {
  RequirePositive("speed_mps", wish.speed_mps);
  const double low = wish.kind == AngleKind::kFace ? -kQuarterTurn : 0.0;
  if (!(wish.angle_rad >= low && wish.angle_rad <= kQuarterTurn)) {
    Refuse(
        "angle_deg", Deg(wish.angle_rad),
        wish.kind == AngleKind::kFace ? "within -90 .. 90" : "within 0 .. 90");
  }
  if (wish.muzzle_height_m) {
    RequireAtLeastZero("muzzle_height_m", *wish.muzzle_height_m);
  }
}

// The radius and face angles need a rectangle.
bool IsRectangle(const Description& rig) {
  return rig.body && rig.body->kind == core::BodyKind::kRectangle;
}

Landing LandingAt(const Description& rig, double face_rad) {
  return Land(rig.body->long_m->value, rig.body->short_m->value,
              std::remainder(face_rad, std::numbers::pi));
}

Expected<Throw> InRange(const Description& rig, const Throw& t) {
  if (t.elevation_rad < rig.elevation_min_rad - kAngleSlack_rad ||
      t.elevation_rad > rig.elevation_max_rad + kAngleSlack_rad) {
    return AbsentBecause(fmt::format(
        "needs an elevation of {:.2f} deg, the rig's is {:g} .. {:g} deg",
        Deg(t.elevation_rad), Deg(rig.elevation_min_rad),
        Deg(rig.elevation_max_rad)));
  }
  if (t.muzzle_height_m < rig.muzzle_height_min_m - kLengthSlack_m ||
      t.muzzle_height_m > rig.muzzle_height_max_m + kLengthSlack_m) {
    return AbsentBecause(fmt::format(
        "needs a muzzle height of {:.1f} mm, the rig's is {:g} .. {:g} mm",
        Mm(t.muzzle_height_m), Mm(rig.muzzle_height_min_m),
        Mm(rig.muzzle_height_max_m)));
  }
  return t;
}

// --- a wanted approach angle ------------------------------------------------

// The throw at centre height `centre_m` at touchdown; `sign` of the elevation.
Expected<Throw> ApproachThrow(const Description& rig, const ContactWish& wish,
                              double centre_m, double sign) {
  const double g = rig.gravity_mps2.value;
  const double down = wish.speed_mps * std::sin(wish.angle_rad);
  const double along =
      std::fmax(0.0, wish.speed_mps * std::cos(wish.angle_rad));
  const double level_m = centre_m + down * down / (2.0 * g);
  const double height = wish.muzzle_height_m.value_or(
      std::clamp(level_m, rig.muzzle_height_min_m, rig.muzzle_height_max_m));
  const double drop = height - centre_m;
  if (drop < -kLengthSlack_m) {
    return AbsentBecause(fmt::format(
        "the muzzle at {:.1f} mm is below the body's centre at touchdown, "
        "{:.1f} mm",
        Mm(height), Mm(centre_m)));
  }
  double up_squared = down * down - 2.0 * g * std::fmax(0.0, drop);
  if (up_squared < -1e-9 * wish.speed_mps * wish.speed_mps) {
    const double fall = std::sqrt(2.0 * g * drop);
    if (fall >= wish.speed_mps) {
      return AbsentBecause(fmt::format(
          "the fall of {:.1f} mm alone gives {:.3g} m/s, more than the wanted "
          "{:.3g}: lower the muzzle",
          Mm(drop), fall, wish.speed_mps));
    }
    return AbsentBecause(fmt::format(
        "the fall of {:.1f} mm alone makes the approach at least {:.2f} deg at "
        "{:.3g} m/s: lower the muzzle to {:.1f} mm or raise the speed",
        Mm(drop), Deg(std::asin(fall / wish.speed_mps)), wish.speed_mps,
        Mm(level_m)));
  }
  up_squared = std::fmax(0.0, up_squared);
  // A level shot, but for the rounding of the difference above.
  if (up_squared < 1e-12 * wish.speed_mps * wish.speed_mps) up_squared = 0.0;
  const double up = up_squared > 0.0 ? sign * std::sqrt(up_squared) : 0.0;
  if (up < 0.0 && drop <= kLengthSlack_m) {
    return AbsentBecause("fired downward at ground height there is no flight");
  }
  return Throw{std::atan2(up, along), height, std::hypot(up, along)};
}

Expected<Throw> ApproachThrow(const Description& rig, const ContactWish& wish,
                              double sign) {
  // A rectangle's centre height at touchdown depends on the attitude, that on
  // the elevation: fixed-point iteration from the level shot.
  double face = rig.seat_angle_rad.value;
  Expected<Throw> t = AbsentBecause("");
  for (int i = 0; i < kIterations; ++i) {
    const double centre = CentreHeightAtTouchdown(rig, face);
    t = ApproachThrow(rig, wish, centre, sign);
    if (!t || !IsRectangle(rig)) break;
    const double drop = std::fmax(0.0, t->muzzle_height_m - centre);
    const Flight flight = Fly(t->launch_speed_mps, t->elevation_rad, drop,
                              rig.gravity_mps2.value);
    const double next = t->elevation_rad + rig.seat_angle_rad.value +
                        rig.spin_rad_per_s.value * flight.time_s;
    if (std::abs(next - face) < 1e-12) break;
    if (i + 1 == kIterations) {
      return AbsentBecause(
          "attitude and flight do not settle: the spin is too strong");
    }
    face = next;
  }
  if (!t) return t;
  if (wish.corner) {
    const auto corner = LandingAt(rig, face).corner;
    if (corner != wish.corner) {
      return AbsentBecause(fmt::format(
          "at an elevation of {:.2f} deg the {} lands first, not the {} corner",
          Deg(t->elevation_rad),
          corner ? std::string(core::Name(*corner)) + " corner" : "middle",
          core::Name(*wish.corner)));
    }
  }
  return InRange(rig, *t);
}

// --- a wanted attitude ------------------------------------------------------

Expected<Throw> AttitudeThrow(const Description& rig, const ContactWish& wish,
                              double face_rad) {
  const Landing landing = LandingAt(rig, face_rad);
  if (wish.corner && landing.corner != wish.corner) {
    return AbsentBecause(fmt::format(
        "at a face angle of {:.2f} deg it is not the {} corner that "
        "lands first",
        Deg(face_rad), core::Name(*wish.corner)));
  }
  const double height = wish.muzzle_height_m.value_or(
      std::clamp(landing.centre_height_m, rig.muzzle_height_min_m,
                 rig.muzzle_height_max_m));
  const double drop = height - landing.centre_height_m;
  if (drop < -kLengthSlack_m) {
    return AbsentBecause(fmt::format(
        "the muzzle at {:.1f} mm is below the body's centre at touchdown, "
        "{:.1f} mm",
        Mm(height), Mm(landing.centre_height_m)));
  }
  const double g = rig.gravity_mps2.value;
  const double fall_squared = 2.0 * g * std::fmax(0.0, drop);
  const double speed_squared = wish.speed_mps * wish.speed_mps - fall_squared;
  if (!(speed_squared > 0.0)) {
    return AbsentBecause(fmt::format(
        "the fall of {:.1f} mm alone gives {:.3g} m/s, the wanted speed is "
        "{:.3g}: lower the muzzle",
        Mm(drop), std::sqrt(fall_squared), wish.speed_mps));
  }
  Throw t{face_rad - rig.seat_angle_rad.value, height,
          std::sqrt(speed_squared)};
  // What spin adds on the way is aimed off: theta = face - seat - omega t.
  for (int i = 0; rig.spin_rad_per_s.value != 0.0; ++i) {
    if (i == kIterations || std::abs(t.elevation_rad) > kQuarterTurn) {
      return AbsentBecause("the spin turns the body too far in its flight");
    }
    const Flight flight =
        Fly(t.launch_speed_mps, t.elevation_rad, std::fmax(0.0, drop), g);
    const double next = face_rad - rig.seat_angle_rad.value -
                        rig.spin_rad_per_s.value * flight.time_s;
    const bool settled = std::abs(next - t.elevation_rad) < 1e-12;
    t.elevation_rad = next;
    if (settled) break;
  }
  if (t.elevation_rad <= 0.0 && drop <= kLengthSlack_m) {
    return AbsentBecause("fired downward at ground height there is no flight");
  }
  return InRange(rig, t);
}

// --- the springs -------------------------------------------------------------

Expected<Setting> WithCompression(const Description& rig, const Throw& t) {
  const Launch launch =
      LaunchOf(rig, std::clamp(t.elevation_rad, -kQuarterTurn, kQuarterTurn));
  const Setting setting{CompressionFor(launch, t.launch_speed_mps),
                        launch.elevation_rad, t.muzzle_height_m};
  for (const Finding& f : CheckCompression(rig, setting.compression_m)) {
    if (f.severity != Severity::kRefusal) continue;
    return AbsentBecause(
        fmt::format("a launch at {:.3g} m/s: {}", t.launch_speed_mps, f.what));
  }
  if (const auto muzzle = LaunchSpeed(launch, setting.compression_m); !muzzle) {
    return AbsentBecause("a launch at rest: " + muzzle.error().reason);
  }
  return setting;
}

// The first of the candidates that the rig can do; else every reason.
Expected<Setting> FirstPossible(const Description& rig,
                                const std::vector<Expected<Throw>>& throws) {
  std::vector<std::string> reasons;
  for (const auto& t : throws) {
    Expected<Setting> setting =
        t ? WithCompression(rig, *t)
          : Expected<Setting>(AbsentBecause(t.error().reason));
    if (setting) return setting;
    const std::string& reason = setting.error().reason;
    if (std::find(reasons.begin(), reasons.end(), reason) == reasons.end()) {
      reasons.push_back(reason);
    }
  }
  return AbsentBecause(fmt::format("{}", fmt::join(reasons, "; or ")));
}

}  // namespace

core::Expected<Setting> SettingFor(const Description& rig,
                                   const ContactWish& wish) {
  Validate(wish);
  if (!IsRectangle(rig)) {
    if (wish.kind != AngleKind::kApproach) {
      return AbsentBecause(fmt::format(
          "a sphere has no {} angle: the contact point is always straight "
          "below its centre",
          core::Name(wish.kind)));
    }
    if (wish.corner) return AbsentBecause("a sphere has no corners");
  }
  if (wish.kind == AngleKind::kApproach) {
    return FirstPossible(
        rig, {ApproachThrow(rig, wish, -1.0), ApproachThrow(rig, wish, 1.0)});
  }
  if (wish.kind == AngleKind::kFace) {
    return FirstPossible(rig, {AttitudeThrow(rig, wish, wish.angle_rad)});
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
  const double tilt = std::fmax(0.0, wish.angle_rad - least);
  return FirstPossible(
      rig, {AttitudeThrow(rig, wish, tilt), AttitudeThrow(rig, wish, -tilt)});
}

core::Expected<SetPoint> PlanContact(const Description& rig,
                                     const ContactWish& wish,
                                     const PredictOptions& options,
                                     std::mt19937_64& engine) {
  const auto setting = SettingFor(rig, wish);
  if (!setting) return AbsentBecause(setting.error().reason);
  return SetPoint{*setting, Predict(rig, *setting, options, engine)};
}

}  // namespace touchdown::rig
