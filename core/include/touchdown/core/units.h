// Units. Inside the program every number is in SI units and radians; degrees,
// millimetres and pixels appear only at the edges (command line, JSON, columns,
// reports), and every field there bears its unit in its name.
//
//   double d = 40 * kMillimetre;           // into SI
//   double shown_mm = d / kMillimetre;     // out of SI
//
// The literals (40.0_mm, 35.0_deg) are for sources and tests; headers must not
// import them.
#pragma once

#include <numbers>

namespace touchdown::core {

inline constexpr double kMillimetre = 1e-3;                  // m
inline constexpr double kDegree = std::numbers::pi / 180.0;  // rad

// Standard acceleration of free fall, m/s^2 (CGPM 1901, exact by definition).
// Local gravity differs by up to 0.3 %; commands accept --gravity.
inline constexpr double kStandardGravity_mps2 = 9.80665;

namespace literals {
constexpr double operator""_mm(long double v) {
  return static_cast<double>(v) * kMillimetre;
}
constexpr double operator""_deg(long double v) {
  return static_cast<double>(v) * kDegree;
}
}  // namespace literals

}  // namespace touchdown::core
