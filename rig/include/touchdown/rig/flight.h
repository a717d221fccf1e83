// From the muzzle to the ground: a parabola, with the attitude kept.
//
// Launch angle is not approach angle: fired level from 0.5 m at 13.27 m/s a
// body lands at 13.28 deg. Air drag is left out; it takes the share rho c A s /
// (2 m) of the speed over a path s: 0.3 % for a steel sphere of 20 mm over 1
// m, 3.5 % for one of wood (c = 0.47). Keep flights short.
#pragma once

#include <optional>

#include "touchdown/core/units.h"
#include "touchdown/core/words.h"

namespace touchdown::rig {

struct Flight {
  double impact_speed_mps = 0.0;
  double normal_mps = 0.0;          // downward part of it, >= 0
  double tangential_mps = 0.0;      // along the ground
  double approach_angle_rad = 0.0;  // 0 .. pi/2
  double time_s = 0.0;              // muzzle to touchdown
  double range_m = 0.0;             // along the ground
};

// Flight of the body's centre, which falls by `drop_m` >= 0 from muzzle to
// touchdown: impact speed sqrt(v^2 + 2 g h), approach angle atan2(sqrt(v^2
// sin^2 + 2 g h), v cos). Elevation within -pi/2 .. pi/2, speed >= 0, gravity
// > 0; throws std::invalid_argument otherwise.
Flight Fly(double speed_mps, double elevation_rad, double drop_m,
           double gravity_mps2 = core::kStandardGravity_mps2);

// How a rectangle meets the ground when its long side is inclined by the face
// angle (positive: leading end up).
struct Landing {
  // Height of the centre when the lowest point touches.
  double centre_height_m = 0.0;
  double radius_angle_rad = 0.0;  // acute, ground to line centre-contact point
  // Which corner is lowest: nose up the trailing one, nose down the leading
  // one, until the body stands steeper than its diagonal. Nothing where the
  // corner is straight below the centre.
  std::optional<core::Corner> corner;
};

// Sides long >= short > 0; |face angle| <= pi/2. A face angle within 1e-9 rad
// of 0 or of a quarter turn is flush; the radius angle is then that of either
// edge. For a tilt up to the diagonal's the radius angle is |face| +
// atan(short/long): no smaller one than atan(short/long) exists. Throws
// std::invalid_argument otherwise.
Landing Land(double long_m, double short_m, double face_angle_rad);

}  // namespace touchdown::rig
