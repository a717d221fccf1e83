#include "touchdown/analysis/theory/corner.h"

#include <cmath>
#include <numbers>

#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

SinCos Split(long double sine, long double cosine) {
  SinCos out;
  out.sin = static_cast<double>(sine);
  out.cos = static_cast<double>(cosine);
  out.sin_low = static_cast<double>(sine - static_cast<long double>(out.sin));
  out.cos_low = static_cast<double>(cosine - static_cast<long double>(out.cos));
  out.has_low = true;
  return out;
}

}  // namespace

SinCos SinCosOfRadians(double alpha_rad) {
  core::RequireFinite("alpha", alpha_rad, "rad");
  const auto angle = static_cast<long double>(alpha_rad);
  return Split(std::sin(angle), std::cos(angle));
}

SinCos SinCosOfDegrees(double alpha_deg) {
  core::RequireFinite("alpha", alpha_deg, "deg");
  // remquo is exact: the rest lies in [-45, 45] deg, `quarter` counts turns of
  // 90 deg in its low bits.
  int quarter = 0;
  const double rest_deg = std::remquo(alpha_deg, 90.0, &quarter);
  const long double rest = static_cast<long double>(rest_deg) *
                           (std::numbers::pi_v<long double> / 180.0L);
  const long double sine =
      std::abs(rest_deg) == 30.0 ? std::copysign(0.5L, rest) : std::sin(rest);
  const long double cosine = std::cos(rest);
  switch (quarter & 3) {
    case 1:
      return Split(cosine, -sine);
    case 2:
      return Split(-sine, -cosine);
    case 3:
      return Split(-cosine, sine);
    default:
      return Split(sine, cosine);
  }
}

SinCos RoundedSinCosOfRadians(double alpha_rad) {
  core::RequireFinite("alpha", alpha_rad, "rad");
  SinCos out;
  out.sin = std::sin(alpha_rad);
  out.cos = std::cos(alpha_rad);
  return out;
}

Delassus ComputeDelassus(const SinCos& alpha, double kappa) {
  return {std::fma(kappa * alpha.cos, alpha.cos, 1.0),
          kappa * alpha.sin * alpha.cos,
          std::fma(kappa * alpha.sin, alpha.sin, 1.0)};
}

double SlidingResponse(const SinCos& alpha, double kappa, double mu,
                       Slip slip) {
  const double t = std::fma(-Sign(slip) * mu, alpha.sin, alpha.cos);
  const double p = kappa * alpha.cos;
  const double p_error = std::fma(kappa, alpha.cos, -p);
  const double r = p * t;
  const double r_error = std::fma(p, t, -r);
  return (1.0 + r) + (r_error + p_error * t);
}

}  // namespace touchdown::analysis
