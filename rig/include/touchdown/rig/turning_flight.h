// Flight of a rectangle that turns on its way, up to its first touch of the
// ground.
//
// With spin the height of the centre at touchdown depends on the attitude, the
// attitude on the time of flight and that on the height: several instants can
// satisfy all three, and the body meets the ground at the first. It is found
// by conservative advancement: with g + r omega^2 >= |h''| of each corner,
//   tau = (h' + sqrt(h'^2 + 2 (g + r omega^2) h)) / (g + r omega^2)
// passes over no root, whatever the spin and the attitude.
#pragma once

#include "touchdown/core/expected.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/flight.h"

namespace touchdown::rig {

struct TurningThrow {
  double long_m = 0.0;  // long >= short > 0
  double short_m = 0.0;
  double speed_mps = 0.0;       // of the centre at the muzzle, >= 0
  double elevation_rad = 0.0;   // of that velocity, within +-pi/2
  double height_m = 0.0;        // of the centre at the muzzle
  double face_rad = 0.0;        // of the long side at the muzzle; any turn
  double spin_rad_per_s = 0.0;  // positive: leading end rising
  double gravity_mps2 = core::kStandardGravity_mps2;  // > 0
};

struct TurningFlight {
  Flight flight;
  double face_rad = 0.0;  // at touchdown, turns counted
};

// Absent where a corner would start in the ground, or where the turning corner
// strikes it while the centre still rises (there is no approach angle then).
// Throws std::invalid_argument for an argument outside its range.
core::Expected<TurningFlight> FlyTurning(const TurningThrow& t);

}  // namespace touchdown::rig
