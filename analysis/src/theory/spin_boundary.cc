#include "touchdown/analysis/theory/spin_boundary.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "theory/wide.h"
#include "touchdown/core/normal.h"
#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

// R omega^2 - g with the rounding errors of both products added back.
Wide Excess(double radius_m, double omega_rad_per_s, double gravity_mps2) {
  const Wide omega = omega_rad_per_s;
  const Wide p = static_cast<Wide>(radius_m) * omega;
  const Wide p_error = std::fma(static_cast<Wide>(radius_m), omega, -p);
  const Wide q = p * omega;
  const Wide q_error = std::fma(p, omega, -q);
  return (q - static_cast<Wide>(gravity_mps2)) + (q_error + p_error * omega);
}

// alpha_b at a spin of x >= threshold.
double SpinBoundaryAngle(double x, double threshold) {
  const double ratio = x / threshold;
  const double w = ratio * ratio;
  return std::atan2(
      1.0, std::sqrt(std::max(0.0, (ratio - 1.0) * (ratio + 1.0)) * (w + 1.0)));
}

// P(x > value) for a normal x.
double UpperTail(double value, double mean, double u) {
  return core::NormalCdf((mean - value) / u);
}

// Integrals of alpha and alpha^2 over the normal density beyond the threshold.
struct Moments {
  double first = 0.0;
  double second = 0.0;

  // Simpson's rule in t with omega = threshold + t^2, which takes the square
  // root out of alpha at the threshold.
  void Add(double mean, double u, double threshold) {
    constexpr double kReach = 12.0;  // in u: beyond it the density is < 1e-31
    const double low = std::max(threshold, mean - kReach * u);
    const double high = mean + kReach * u;
    if (high <= low) return;
    const double t_low = std::sqrt(low - threshold);
    const double t_high = std::sqrt(high - threshold);
    constexpr int kPanels = 4000;  // even; error below 1e-10 of the result
    const double step = (t_high - t_low) / kPanels;
    for (int i = 0; i <= kPanels; ++i) {
      const double t = t_low + i * step;
      const double omega = threshold + t * t;
      const double z = (omega - mean) / u;
      const double density =
          std::exp(-0.5 * z * z) / (u * std::sqrt(2.0 * std::numbers::pi));
      const double simpson = i == 0 || i == kPanels ? 1.0 : (i % 2 ? 4.0 : 2.0);
      const double weight = simpson * step / 3.0 * 2.0 * t * density;
      const double alpha = SpinBoundaryAngle(omega, threshold);
      first += weight * alpha;
      second += weight * alpha * alpha;
    }
  }
};

}  // namespace

SpinBoundary SolveSpinBoundary(double radius_m, double omega_rad_per_s,
                               double gravity_mps2) {
  core::RequirePositive("radius", radius_m, "m");
  core::RequireFinite("omega", omega_rad_per_s, "rad/s");
  core::RequirePositive("gravity", gravity_mps2, "m/s^2");
  const Wide g = gravity_mps2;
  const Wide omega = omega_rad_per_s;
  const Wide excess = Excess(radius_m, omega_rad_per_s, gravity_mps2);
  const Wide w_minus_1 = excess / g;
  SpinBoundary out;
  out.w = Narrow(static_cast<Wide>(radius_m) * omega * omega / g);
  out.w_minus_1 = Narrow(w_minus_1);
  if (excess < 0) return out;
  if (excess == 0) {
    out.status = SpinBoundaryStatus::kAt90;
    out.alpha_rad = std::numbers::pi / 2.0;
    return out;
  }
  out.status = SpinBoundaryStatus::kExists;
  const Wide root = std::sqrt(w_minus_1) * std::sqrt(w_minus_1 + 2);
  const Wide tangent = 1 / root;
  const Wide alpha = std::atan2(Wide(1), root);
  out.alpha_rad = Narrow(alpha);
  out.d_omega = Narrow(-2 * tangent / omega);
  out.d_radius = Narrow(-tangent / static_cast<Wide>(radius_m));
  out.d_gravity = Narrow(tangent / g);
  out.d2_omega =
      Narrow(tangent / omega / omega * (2 + 4 * (1 + tangent * tangent)));
  out.condition = Narrow(2 * tangent / alpha);
  return out;
}

SpinBoundaryUncertainty SpinBoundaryOfUncertainOmega(double radius_m,
                                                     double omega_rad_per_s,
                                                     double u_omega,
                                                     double gravity_mps2) {
  core::RequirePositive("u of omega", u_omega, "rad/s");
  const SpinBoundary mean =
      SolveSpinBoundary(radius_m, omega_rad_per_s, gravity_mps2);
  // alpha depends on |omega|.
  const double omega = std::abs(omega_rad_per_s);
  const double threshold = std::sqrt(gravity_mps2) / std::sqrt(radius_m);
  SpinBoundaryUncertainty out;
  out.p_none = UpperTail(-threshold, -omega, u_omega) -
               UpperTail(threshold, -omega, u_omega);
  if (mean.status == SpinBoundaryStatus::kExists) {
    out.first_order_u_rad = std::abs(mean.d_omega) * u_omega;
    out.second_order_mean_rad =
        mean.alpha_rad + 0.5 * mean.d2_omega * u_omega * u_omega;
    // Standard uncertainties between w and its limit 1 (as in
    // boundary_uncertainty.cc).
    constexpr double kSafety = 10.0;
    const double u_w = 2.0 * mean.w / omega * u_omega;
    out.first_order_is_valid = mean.w_minus_1 > kSafety * u_w;
  }
  const double above = UpperTail(threshold, omega, u_omega);
  const double below = UpperTail(threshold, -omega, u_omega);
  const double p_exists = above + below;
  // Probability below which no boundary exists for this spin.
  constexpr double kNegligible = 1e-12;
  if (p_exists < kNegligible) return out;
  Moments moments;
  moments.Add(omega, u_omega, threshold);
  moments.Add(-omega, u_omega, threshold);
  const double average = moments.first / p_exists;
  out.mean_rad = average;
  out.u_rad =
      std::sqrt(std::max(0.0, moments.second / p_exists - average * average));
  // alpha <= a where |omega| >= x(a): the p quantile of alpha is at the x that
  // has p of the tails beyond it.
  const auto quantile = [&](double p) {
    double low = threshold;
    double high = std::max(threshold, omega) + 40.0 * u_omega;
    for (int i = 0; i < 200 && low < high; ++i) {
      const double middle = low + 0.5 * (high - low);
      if (middle == low || middle == high) break;
      const double beyond = UpperTail(middle, omega, u_omega) +
                            UpperTail(middle, -omega, u_omega);
      (beyond > p * p_exists ? low : high) = middle;
    }
    return SpinBoundaryAngle(high, threshold);
  };
  out.low_rad = quantile(0.025);
  out.high_rad = quantile(0.975);
  return out;
}

}  // namespace touchdown::analysis
