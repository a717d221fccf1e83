#include "touchdown/rig/flight.h"

#include <cmath>

#include "angles.h"
#include "touchdown/core/require.h"

namespace touchdown::rig {
namespace {

constexpr double kFlush_rad = 1e-9;  // far below any protractor, above rounding

}  // namespace

Flight Fly(double speed_mps, double elevation_rad, double drop_m,
           double gravity_mps2) {
  core::RequireNotNegative("speed_mps", speed_mps);
  core::RequireNotNegative("drop_m", drop_m);
  core::RequirePositive("gravity_mps2", gravity_mps2);
  if (!(std::abs(elevation_rad) <= kQuarterTurn * (1.0 + 1e-12))) {
    core::Refuse("elevation_rad", elevation_rad, "within -pi/2 .. pi/2");
  }
  const double up = speed_mps * std::sin(elevation_rad);
  // cos of the double nearest pi/2 is 6e-17, not 0, and may be negative beyond.
  const double along = std::fmax(0.0, speed_mps * std::cos(elevation_rad));
  const double fall = std::sqrt(2.0 * gravity_mps2 * drop_m);
  Flight flight;
  flight.normal_mps = std::hypot(up, fall);
  flight.tangential_mps = along;
  flight.impact_speed_mps = std::hypot(flight.normal_mps, along);
  flight.approach_angle_rad = std::atan2(flight.normal_mps, along);
  // t = (up + normal)/g; fired downward that subtracts, so we use the other
  // form of the root.
  if (up >= 0.0) {
    flight.time_s = (up + flight.normal_mps) / gravity_mps2;
  } else {
    flight.time_s = 2.0 * drop_m / (flight.normal_mps - up);
  }
  flight.range_m = along * flight.time_s;
  return flight;
}

Landing Land(double long_m, double short_m, double face_angle_rad) {
  core::RequirePositive("short_m", short_m);
  if (!(long_m >= short_m) || !std::isfinite(long_m)) {
    core::Refuse("long_m", long_m, "at least short_m and finite");
  }
  const double tilt = std::abs(face_angle_rad);
  if (!(tilt <= kQuarterTurn * (1.0 + 1e-12))) {
    core::Refuse("face_angle_rad", face_angle_rad, "within -pi/2 .. pi/2");
  }
  const double c = std::fmax(0.0, std::cos(tilt));
  const double s = std::sin(tilt);
  Landing landing;
  landing.centre_height_m = 0.5 * (long_m * s + short_m * c);
  // How far the lowest corner lies behind the centre, nose up.
  const double behind = 0.5 * (long_m * c - short_m * s);
  landing.radius_angle_rad =
      std::atan2(landing.centre_height_m, std::abs(behind));
  if (tilt < kFlush_rad || tilt > kQuarterTurn - kFlush_rad) {
    landing.corner = core::Corner::kFlush;
  } else if (std::abs(behind) > kFlush_rad * long_m) {
    const bool nose_up = face_angle_rad > 0.0;
    landing.corner = nose_up == (behind > 0.0) ? core::Corner::kTrailing
                                               : core::Corner::kLeading;
  }
  return landing;
}

}  // namespace touchdown::rig
