// The few special functions that the statistics need and <cmath> lacks.
#pragma once

namespace touchdown::analysis {

// Logarithm of the standard normal density (core/normal.h).
double LogNormalDensity(double z);

// log Phi(z), accurate where Phi underflows: the asymptotic series
// of Abramowitz and Stegun 26.2.12 below z = -30. Any finite z.
double LogNormalCdf(double z);

// z with Phi(z) = p; 0 < p < 1 (throws std::invalid_argument). Relative
// error of a few ulp: Newton steps on a rational start.
double NormalQuantile(double p);

// Regularized incomplete beta function I_x(a, b), a, b > 0, 0 <= x <= 1, by the
// continued fraction of Abramowitz and Stegun 26.5.8.
double RegularizedBeta(double a, double b, double x);

// x with I_x(a, b) = p; 0 <= p <= 1.
double BetaQuantile(double a, double b, double p);

// P(X = k) of a binomial variable, n >= 0, 0 <= k <= n, 0 <= p <= 1.
double BinomialProbability(int k, int n, double p);

}  // namespace touchdown::analysis
