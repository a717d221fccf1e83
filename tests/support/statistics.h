// How far a sample may lie from what is claimed of it before a test says so.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace touchdown::testing {

struct Band {
  double low = 0.0;
  double high = 0.0;
};

// The central 99.99 % band (hundreds of such checks are made: one false alarm
// in a hundred runs of all) of the root mean square of `n` independent standard
// normal numbers: sqrt(chi2_n / n), the quantiles by Wilson and Hilferty's cube
// (to 1 % from n = 5 on).
inline Band RmsBand9999(std::size_t n) {
  constexpr double kNormal99995 = 3.8905918864131;
  const double a = 2.0 / (9.0 * static_cast<double>(n));
  const auto root = [&](double z) {
    return std::pow(std::fmax(0.0, 1.0 - a + z * std::sqrt(a)), 1.5);
  };
  return {root(-kNormal99995), root(kNormal99995)};
}

inline double Rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

inline double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

inline double Largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double v : values) most = std::fmax(most, std::abs(v));
  return most;
}

}  // namespace touchdown::testing
