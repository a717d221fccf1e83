// The standard normal distribution.
#pragma once

#include <cmath>
#include <numbers>

namespace touchdown::core {

// exp(-z^2 / 2) / sqrt(2 pi).
inline double NormalDensity(double z) {
  return std::exp(-0.5 * z * z) * std::numbers::inv_sqrtpi /
         std::numbers::sqrt2;
}

// Phi(z), of full relative accuracy in the lower tail, down to z = -37.
inline double NormalCdf(double z) {
  return 0.5 * std::erfc(-z * (std::numbers::sqrt2 / 2.0));
}

}  // namespace touchdown::core
