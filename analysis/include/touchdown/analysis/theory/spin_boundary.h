// The contact angle above which spin lifts a corner off the ground: b = 0, i.e.
//   R omega^2 sin(alpha_b) = g,   w = R omega^2 / g,   alpha_b = arcsin(1/w)
// (the paper's only boundary, its Sec. 3.3 for omega != 0), evaluated as
//   alpha_b = atan2(1, sqrt((w - 1)(w + 1)))
// with w - 1 from exact products, because arcsin loses half the digits near 1.
// There is none for R omega^2 < g: then the corner stays down at every angle
// (errata E15). Contains neither the body's shape nor mu (E16); omega is the
// one after the impact (E9).
#pragma once

#include <optional>

namespace touchdown::analysis {

enum class SpinBoundaryStatus {
  kExists,
  kAt90,  // R omega^2 = g exactly: alpha_b = 90 deg, derivatives infinite
  kNone   // R omega^2 < g
};

struct SpinBoundary {
  SpinBoundaryStatus status = SpinBoundaryStatus::kNone;
  double w = 0.0;          // R omega^2 / g
  double w_minus_1 = 0.0;  // with full relative precision
  // From here on 0 where there is no boundary.
  double alpha_rad = 0.0;
  double d_omega = 0.0;    // d alpha / d omega = -2 tan(alpha)/omega, rad s/rad
  double d_radius = 0.0;   // -tan(alpha)/R, rad/m
  double d_gravity = 0.0;  // tan(alpha)/g, rad s^2/m
  double d2_omega = 0.0;   // second derivative
  double condition = 0.0;  // |relative change| of alpha per one of omega
};

// `radius_m` and `gravity_mps2` > 0, all finite; else std::invalid_argument.
SpinBoundary SolveSpinBoundary(double radius_m, double omega_rad_per_s,
                               double gravity_mps2);

// What a normally distributed omega makes of the boundary: a part without one,
// and a continuous part, whose width grows as the square root of u near
// R omega^2 = g, where first-order propagation diverges.
struct SpinBoundaryUncertainty {
  double p_none = 0.0;  // P(R omega^2 < g)
  // tan(alpha) 2 u/|omega|; nothing where the mean itself has no boundary.
  std::optional<double> first_order_u_rad;
  std::optional<double> second_order_mean_rad;
  // w - 1 > 10 u(w): the first-order u may be used.
  bool first_order_is_valid = false;
  // Given that there is a boundary; nothing where P(boundary) < 1e-12.
  std::optional<double> mean_rad;
  std::optional<double> u_rad;
  std::optional<double> low_rad;   // 2.5 % quantile
  std::optional<double> high_rad;  // 97.5 % quantile
};

// By quadrature, to about 1e-9 relative. `u_omega` > 0.
SpinBoundaryUncertainty SpinBoundaryOfUncertainOmega(double radius_m,
                                                     double omega_rad_per_s,
                                                     double u_omega,
                                                     double gravity_mps2);

}  // namespace touchdown::analysis
