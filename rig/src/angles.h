// Angles of a throw, as all of the module counts them.
#pragma once

#include <numbers>

#include "touchdown/core/units.h"

namespace touchdown::rig {

// rad: 90 deg.
inline constexpr double kQuarterTurn = std::numbers::pi / 2.0;
// Rounding at limits given in degrees.
inline constexpr double kAngleSlack_rad = 1e-9;

inline double Deg(double rad) { return rad / core::kDegree; }

}  // namespace touchdown::rig
