#include "touchdown/analysis/statistics/agreement_statistics.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "touchdown/analysis/statistics/special_functions.h"

namespace touchdown::analysis {
namespace {

// For a statistic that the table does not define.
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void CheckProportion(int x, int n, double level) {
  if (n < 1 || x < 0 || x > n || !(level > 0.0 && level < 1.0)) {
    throw std::invalid_argument(fmt::format(
        "x is {}, n is {}, level is {}; they must be 0 <= x <= n, n >= 1 and "
        "0 < level < 1",
        x, n, level));
  }
}

}  // namespace

core::Interval WilsonInterval(int x, int n, double level) {
  CheckProportion(x, n, level);
  const double z = NormalQuantile(0.5 + level / 2);
  const double nd = n;
  const double p = x / nd;
  const double centre = p + z * z / (2 * nd);
  const double half = z * std::sqrt(p * (1 - p) / nd + z * z / (4 * nd * nd));
  const double scale = 1 + z * z / nd;
  // At the ends the formula gives exactly 0 or 1, up to rounding.
  return {x == 0 ? 0.0 : (centre - half) / scale,
          x == n ? 1.0 : (centre + half) / scale};
}

core::Interval ClopperPearsonInterval(int x, int n, double level) {
  CheckProportion(x, n, level);
  const double tail = (1 - level) / 2;
  const double xd = x;
  const double nd = n;
  return {x == 0 ? 0.0 : BetaQuantile(xd, nd - xd + 1, tail),
          x == n ? 1.0 : BetaQuantile(xd + 1, nd - xd, 1 - tail)};
}

CohensKappa CohenKappa(const TwoByTwo& t) {
  if (t.a < 0 || t.b < 0 || t.c < 0 || t.d < 0 || t.total() == 0) {
    throw std::invalid_argument(
        fmt::format("counts {}, {}, {}, {}; none may be negative and not all 0",
                    t.a, t.b, t.c, t.d));
  }
  const double n = t.total();
  const double share[2][2] = {{t.a / n, t.b / n}, {t.c / n, t.d / n}};
  const double row[2] = {share[0][0] + share[0][1], share[1][0] + share[1][1]};
  const double column[2] = {share[0][0] + share[1][0],
                            share[0][1] + share[1][1]};
  const double chance = row[0] * column[0] + row[1] * column[1];
  if (chance >= 1.0) return {kNaN, kNaN, kNaN};
  CohensKappa out;
  out.kappa = (share[0][0] + share[1][1] - chance) / (1 - chance);
  // Fleiss, Cohen and Everitt (1969), eqs. (8) and (9).
  double sum = 0.0;
  double sum0 = 0.0;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      const double agrees = i == j ? 1.0 : 0.0;
      const double both = column[i] + row[j];
      const double term = agrees - both * (1 - out.kappa);
      const double term0 = agrees - both;
      sum += share[i][j] * term * term;
      sum0 += row[i] * column[j] * term0 * term0;
    }
  }
  const double shift = out.kappa - chance * (1 - out.kappa);
  out.ase = std::sqrt(std::max(sum - shift * shift, 0.0) / n) / (1 - chance);
  out.ase0 =
      std::sqrt(std::max(sum0 - chance * chance, 0.0) / n) / (1 - chance);
  return out;
}

double MatthewsCorrelation(const TwoByTwo& t) {
  const double a = t.a;
  const double b = t.b;
  const double c = t.c;
  const double d = t.d;
  const double margins = (a + b) * (c + d) * (a + c) * (b + d);
  return margins > 0.0 ? (a * d - b * c) / std::sqrt(margins) : kNaN;
}

McNemar McNemarTest(int b, int c) {
  if (b < 0 || c < 0) {
    throw std::invalid_argument(
        fmt::format("b is {} and c is {}; neither may be negative", b, c));
  }
  McNemar out;
  const int n = b + c;
  if (n == 0) return out;
  const int least = std::min(b, c);
  double tail = 0.0;
  for (int k = 0; k <= least; ++k) tail += BinomialProbability(k, n, 0.5);
  out.p_exact = std::min(1.0, 2 * tail);
  const double point = BinomialProbability(least, n, 0.5);
  // With b = c both tails hold the middle, and mid-p is 1 - half of it.
  out.p_mid = b == c ? 1.0 - point / 2 : 2 * tail - point;
  return out;
}

double NormalizedError(double value, double expanded_u, double reference,
                       double reference_expanded_u) {
  const double u = std::hypot(expanded_u, reference_expanded_u);
  if (!(u > 0.0)) {
    throw std::invalid_argument(fmt::format(
        "expanded_u is {} and reference_expanded_u is {}; one must be positive",
        expanded_u, reference_expanded_u));
  }
  return (value - reference) / u;
}

}  // namespace touchdown::analysis
