#include "theory/rigid_outline.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

double RequireSize(const core::Measured& size, const char* name) {
  if (!size) {
    throw std::invalid_argument(fmt::format("{} is absent ({}), must be given",
                                            name, size.error().reason));
  }
  core::RequirePositive(name, size->value, "m");
  return size->value;
}

}  // namespace

RigidOutline::RigidOutline(const core::Body& body)
    : is_sphere_(body.kind == core::BodyKind::kSphere) {
  if (is_sphere_) {
    radius_m_ = 0.5 * RequireSize(body.diameter_m, "diameter");
  } else {
    half_long_m_ = 0.5 * RequireSize(body.long_m, "long side");
    half_short_m_ = 0.5 * RequireSize(body.short_m, "short side");
    radius_m_ = std::hypot(half_long_m_, half_short_m_);
  }
}

double RigidOutline::GyrationRadius() const {
  return is_sphere_ ? std::sqrt(0.4) * radius_m_ : radius_m_ / std::sqrt(3.0);
}

std::array<CornerState, 4> RigidOutline::Corners(const BodyState& state) const {
  const double c = std::cos(state.angle_rad);
  const double s = std::sin(state.angle_rad);
  std::array<CornerState, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const double u = i == 0 || i == 3 ? half_long_m_ : -half_long_m_;
    const double v = i < 2 ? half_short_m_ : -half_short_m_;
    const double x = c * u - s * v;
    const double y = s * u + c * v;
    corners[i] = {
        {x, y}, state.centre.y_m + y, state.vy_mps + state.omega_rad_per_s * x};
  }
  return corners;
}

double RigidOutline::Gap(const BodyState& state) const {
  if (is_sphere_) return state.centre.y_m - radius_m_;
  double gap = std::numeric_limits<double>::infinity();
  for (const CornerState& corner : Corners(state)) {
    gap = std::min(gap, corner.y_m);
  }
  return gap;
}

double RigidOutline::TimeToContact(const BodyState& state, double gravity_mps2,
                                   double limit_s) const {
  // Heights h with |h''| <= M have no root within the step below; next to a
  // root it is Newton's step.
  const auto safe_step = [](double h, double v, double m) {
    const double root = std::sqrt(v * v + 2.0 * m * std::max(0.0, h));
    // Without cancellation for v < 0.
    return v >= 0.0 ? (v + root) / m : 2.0 * std::max(0.0, h) / (root - v);
  };
  if (is_sphere_) {
    return safe_step(state.centre.y_m - radius_m_, state.vy_mps, gravity_mps2);
  }
  const double w = state.omega_rad_per_s;
  const double bound = gravity_mps2 + radius_m_ * w * w;
  const Stretch flight{StretchKind::kFlight, state, 0.0, -gravity_mps2, 0.0};
  double elapsed = 0.0;
  while (elapsed <= limit_s) {
    const BodyState now = Advance(flight, state.time_s + elapsed);
    double step = std::numeric_limits<double>::infinity();
    for (const CornerState& corner : Corners(now)) {
      step = std::min(step, safe_step(corner.y_m, corner.vy_mps, bound));
    }
    // Below the resolution of time: this is the root.
    if (step <= 4e-16 * (std::abs(state.time_s) + elapsed) + 1e-18) break;
    elapsed += step;
  }
  return elapsed;
}

BodyState Advance(const Stretch& stretch, double time_s) {
  BodyState state = stretch.start;
  const double t = time_s - state.time_s;
  state.time_s = time_s;
  state.centre.x_m += t * (state.vx_mps + 0.5 * t * stretch.ax_mps2);
  state.centre.y_m += t * (state.vy_mps + 0.5 * t * stretch.ay_mps2);
  state.angle_rad += t * (state.omega_rad_per_s +
                          0.5 * t * stretch.angular_acceleration_rad_per_s2);
  state.vx_mps += t * stretch.ax_mps2;
  state.vy_mps += t * stretch.ay_mps2;
  state.omega_rad_per_s += t * stretch.angular_acceleration_rad_per_s2;
  return state;
}

}  // namespace touchdown::analysis
