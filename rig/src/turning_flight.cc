#include "touchdown/rig/turning_flight.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "angles.h"
#include "infinity.h"
#include "touchdown/core/require.h"

namespace touchdown::rig {
namespace {

// What lies less deep than this at the muzzle lies on the ground. 1 nm: above
// rounding, far below what anyone sets.
constexpr double kOnGround_m = 1e-9;
// Steps shorter than this change nothing that is given: a touch. 1e-14 s at
// 100 m/s are 1 pm.
constexpr double kTouch_s = 1e-14;
// Grazing touches are approached by halves: 200 steps are more than any needs.
constexpr int kMostSteps = 100'000;

void ValidateThrow(const TurningThrow& t) {
  core::RequirePositive("short_m", t.short_m);
  if (!(t.long_m >= t.short_m) || !std::isfinite(t.long_m)) {
    core::Refuse("long_m", t.long_m, "at least short_m and finite");
  }
  core::RequireNotNegative("speed_mps", t.speed_mps);
  core::RequireFinite("height_m", t.height_m);
  core::RequireFinite("face_rad", t.face_rad);
  core::RequireFinite("spin_rad_per_s", t.spin_rad_per_s);
  core::RequirePositive("gravity_mps2", t.gravity_mps2);
  if (!(std::abs(t.elevation_rad) <= kQuarterTurn * (1.0 + 1e-12))) {
    core::Refuse("elevation_rad", t.elevation_rad, "within -pi/2 .. pi/2");
  }
}

// Height and its rate of the corner at (along, across) of the body's axes.
struct CornerHeight {
  double height_m = 0.0;
  double rate_mps = 0.0;
};

std::array<CornerHeight, 4> ComputeCorners(const TurningThrow& t, double time_s,
                                           double up_mps) {
  const double y =
      t.height_m + time_s * (up_mps - 0.5 * t.gravity_mps2 * time_s);
  const double rise = up_mps - t.gravity_mps2 * time_s;
  const double face = t.face_rad + t.spin_rad_per_s * time_s;
  const double s = std::sin(face);
  const double c = std::cos(face);
  std::array<CornerHeight, 4> out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double along = (i & 1U ? 0.5 : -0.5) * t.long_m;
    const double across = (i & 2U ? 0.5 : -0.5) * t.short_m;
    out[i] = {y + along * s + across * c,
              rise + t.spin_rad_per_s * (along * c - across * s)};
  }
  return out;
}

}  // namespace

core::Expected<TurningFlight> FlyTurning(const TurningThrow& t) {
  ValidateThrow(t);
  const double up = t.speed_mps * std::sin(t.elevation_rad);
  const double along = std::fmax(0.0, t.speed_mps * std::cos(t.elevation_rad));
  const double reach = 0.5 * std::hypot(t.long_m, t.short_m);
  const double bend =
      t.gravity_mps2 + reach * t.spin_rad_per_s * t.spin_rad_per_s;
  double time = 0.0;
  for (int i = 0; i < kMostSteps; ++i) {
    double step = kInf;
    for (const CornerHeight& corner : ComputeCorners(t, time, up)) {
      if (i == 0 && corner.height_m < -kOnGround_m) {
        return core::AbsentBecause(fmt::format(
            "the body would start {:.3g} mm deep in the ground: raise the "
            "muzzle",
            -corner.height_m * 1e3));
      }
      const double h = std::fmax(0.0, corner.height_m);
      const double v = corner.rate_mps;
      const double root = std::sqrt(v * v + 2.0 * bend * h);
      // Of the two forms the one that does not subtract.
      step =
          std::fmin(step, v < 0.0 ? 2.0 * h / (root - v) : (v + root) / bend);
    }
    time += step;
    if (step <= kTouch_s) break;
  }
  const double down = t.gravity_mps2 * time - up;
  if (down < 0.0) {
    return core::AbsentBecause(fmt::format(
        "a corner of the turning body strikes the ground after {:.3g} ms, "
        "while its centre still rises",
        time * 1e3));
  }
  TurningFlight out;
  out.face_rad = t.face_rad + t.spin_rad_per_s * time;
  Flight& f = out.flight;
  f.normal_mps = down;
  f.tangential_mps = along;
  f.impact_speed_mps = std::hypot(down, along);
  f.approach_angle_rad = std::atan2(down, along);
  f.time_s = time;
  f.range_m = along * time;
  return out;
}

}  // namespace touchdown::rig
