#include "touchdown/analysis/statistics/special_functions.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "touchdown/core/normal.h"

namespace touchdown::analysis {
namespace {

// Of the normal density.
const double kLogSqrtTwoPi = 0.5 * std::log(2 * std::numbers::pi);

// Below this z the series is used: its sixth term is then 1e-14 of the first,
// and erfc is still a normal number above it.
constexpr double kSeriesBelow = -30.0;

// Lentz's method for the continued fraction of I_x(a, b).
double BetaFraction(double a, double b, double x) {
  // Lentz's method: a denominator of 0 is taken for this.
  constexpr double kTiny = 1e-300;
  constexpr int kMaxTerms = 10000;  // ~ sqrt(max(a, b)) terms are needed
  double c = 1.0;
  double d = 1.0 - (a + b) * x / (a + 1.0);
  if (std::abs(d) < kTiny) d = kTiny;
  d = 1.0 / d;
  double h = d;
  for (int m = 1; m <= kMaxTerms; ++m) {
    const double even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
    const double odd =
        -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
    double step = 1.0;
    for (const double term : {even, odd}) {
      d = 1.0 + term * d;
      if (std::abs(d) < kTiny) d = kTiny;
      c = 1.0 + term / c;
      if (std::abs(c) < kTiny) c = kTiny;
      d = 1.0 / d;
      step = d * c;
      h *= step;
    }
    if (std::abs(step - 1.0) < 4 * std::numeric_limits<double>::epsilon()) {
      break;
    }
  }
  return h;
}

}  // namespace

double LogNormalDensity(double z) { return -0.5 * z * z - kLogSqrtTwoPi; }

double LogNormalCdf(double z) {
  if (z > 5.0) return std::log1p(-core::NormalCdf(-z));
  if (z >= kSeriesBelow) return std::log(core::NormalCdf(z));
  const double w = 1.0 / (z * z);
  const double series =
      w * (-1.0 + w * (3.0 + w * (-15.0 + w * (105.0 + w * -945.0))));
  return -0.5 * z * z - kLogSqrtTwoPi - std::log(-z) + std::log1p(series);
}

double NormalQuantile(double p) {
  if (!(p > 0.0 && p < 1.0)) {
    throw std::invalid_argument(
        fmt::format("p is {}; it must lie between 0 and 1", p));
  }
  if (p > 0.5) return -NormalQuantile(1.0 - p);
  // Abramowitz and Stegun 26.2.23, error < 4.5e-4; then Newton on log Phi,
  // whose derivative is the inverse Mills ratio.
  const double t = std::sqrt(-2.0 * std::log(p));
  double z = -(t - (2.515517 + t * (0.802853 + t * 0.010328)) /
                       (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308))));
  for (int i = 0; i < 4; ++i) {
    const double log_cdf = LogNormalCdf(z);
    const double slope = std::exp(-0.5 * z * z - kLogSqrtTwoPi - log_cdf);
    z -= (log_cdf - std::log(p)) / slope;
  }
  return z;
}

double RegularizedBeta(double a, double b, double x) {
  if (!(a > 0.0) || !(b > 0.0) || !(x >= 0.0 && x <= 1.0)) {
    throw std::invalid_argument(fmt::format(
        "I_x(a, b) with a {}, b {}, x {}: a and b must be positive and x "
        "between 0 and 1",
        a, b, x));
  }
  if (x == 0.0 || x == 1.0) return x;
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) +
               a * std::log(x) + b * std::log1p(-x));
  // The fraction converges fast on this side of the mean.
  if (x < (a + 1.0) / (a + b + 2.0)) return front * BetaFraction(a, b, x) / a;
  return 1.0 - front * BetaFraction(b, a, 1.0 - x) / b;
}

double BetaQuantile(double a, double b, double p) {
  if (!(p >= 0.0 && p <= 1.0)) {
    throw std::invalid_argument(
        fmt::format("p is {}; it must lie between 0 and 1", p));
  }
  if (p == 0.0 || p == 1.0) return p;
  double low = 0.0;
  double high = 1.0;
  // Bisection to the last bit: some hundred steps at most, no case fails.
  while (true) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle;
    (RegularizedBeta(a, b, middle) < p ? low : high) = middle;
  }
}

double BinomialProbability(int k, int n, double p) {
  if (p <= 0.0) return k == 0 ? 1.0 : 0.0;
  if (p >= 1.0) return k == n ? 1.0 : 0.0;
  const double nd = n;
  const double kd = k;
  return std::exp(std::lgamma(nd + 1) - std::lgamma(kd + 1) -
                  std::lgamma(nd - kd + 1) + kd * std::log(p) +
                  (nd - kd) * std::log1p(-p));
}

}  // namespace touchdown::analysis
