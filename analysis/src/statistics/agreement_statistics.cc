#include "touchdown/analysis/statistics/agreement_statistics.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "touchdown/analysis/statistics/special_functions.h"
#include "touchdown/core/normal.h"

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

void CheckEquivalence(double standard_error, double margin, double alpha) {
  if (!(standard_error > 0.0) || !(margin > 0.0) ||
      !(alpha > 0.0 && alpha < 0.5)) {
    throw std::invalid_argument(
        fmt::format("standard error is {}, margin is {}, alpha is {}; the "
                    "first two must be positive, alpha between 0 and 0.5",
                    standard_error, margin, alpha));
  }
}

// P(chi^2 with one degree of freedom > x).
double ChiSquareUpperTail(double x) { return std::erfc(std::sqrt(x / 2)); }

double LogChoose(int n, int k) {
  return std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0);
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

double ClopperPearsonLowerLimit(int x, int n, double level) {
  CheckProportion(x, n, level);
  const double xd = x;
  return x == 0 ? 0.0 : BetaQuantile(xd, n - xd + 1, 1 - level);
}

CohensKappa CohenKappa(std::span<const int> counts, int k,
                       KappaWeights weights) {
  const bool sizes = k >= 2 && counts.size() == static_cast<std::size_t>(k) *
                                                    static_cast<std::size_t>(k);
  const bool all_positive =
      std::all_of(counts.begin(), counts.end(), [](int c) { return c >= 0; });
  const double n = std::accumulate(counts.begin(), counts.end(), 0.0);
  if (!sizes || !all_positive || n <= 0.0) {
    throw std::invalid_argument(fmt::format(
        "{} counts with sum {} for {} categories; there must be k * k counts, "
        "k >= 2, none negative, not all 0",
        counts.size(), n, k));
  }
  const auto at = [&](int i, int j) {
    return counts[static_cast<std::size_t>(i) * static_cast<std::size_t>(k) +
                  static_cast<std::size_t>(j)] /
           n;
  };
  const auto weight = [&](int i, int j) {
    if (weights == KappaWeights::kNone) return i == j ? 1.0 : 0.0;
    return 1.0 - std::abs(i - j) / (k - 1.0);
  };
  std::vector<double> row(static_cast<std::size_t>(k), 0.0);
  std::vector<double> column(row);
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < k; ++j) {
      row[static_cast<std::size_t>(i)] += at(i, j);
      column[static_cast<std::size_t>(j)] += at(i, j);
    }
  }
  const auto r = [&](int i) { return row[static_cast<std::size_t>(i)]; };
  const auto c = [&](int j) { return column[static_cast<std::size_t>(j)]; };
  std::vector<double> row_weight(row.size(), 0.0);     // sum_j c_j w_ij
  std::vector<double> column_weight(row.size(), 0.0);  // sum_i r_i w_ij
  double observed = 0.0;
  double chance = 0.0;
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < k; ++j) {
      observed += weight(i, j) * at(i, j);
      chance += weight(i, j) * r(i) * c(j);
      row_weight[static_cast<std::size_t>(i)] += c(j) * weight(i, j);
      column_weight[static_cast<std::size_t>(j)] += r(i) * weight(i, j);
    }
  }
  if (chance >= 1.0) return {kNaN, kNaN, kNaN};
  CohensKappa out;
  out.kappa = (observed - chance) / (1 - chance);
  // Fleiss, Cohen and Everitt (1969), eqs. (8) and (9).
  double sum = 0.0;
  double sum0 = 0.0;
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < k; ++j) {
      const double both = row_weight[static_cast<std::size_t>(i)] +
                          column_weight[static_cast<std::size_t>(j)];
      const double term = weight(i, j) - both * (1 - out.kappa);
      const double term0 = weight(i, j) - both;
      sum += at(i, j) * term * term;
      sum0 += r(i) * c(j) * term0 * term0;
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
  const double difference = std::abs(b - c);
  out.chi_square = difference * difference / n;
  const double corrected = std::max(difference - 1, 0.0);
  out.chi_square_corrected = corrected * corrected / n;
  out.p_corrected = ChiSquareUpperTail(out.chi_square_corrected);
  const int least = std::min(b, c);
  double tail = 0.0;
  for (int k = 0; k <= least; ++k) tail += BinomialProbability(k, n, 0.5);
  out.p_exact = std::min(1.0, 2 * tail);
  const double point = BinomialProbability(least, n, 0.5);
  // With b = c both tails hold the middle, and mid-p is 1 - half of it.
  out.p_mid = b == c ? 1.0 - point / 2 : 2 * tail - point;
  return out;
}

Fisher FisherExactTest(const TwoByTwo& t) {
  if (t.a < 0 || t.b < 0 || t.c < 0 || t.d < 0 || t.total() == 0) {
    throw std::invalid_argument(
        fmt::format("counts {}, {}, {}, {}; none may be negative and not all 0",
                    t.a, t.b, t.c, t.d));
  }
  const int row = t.a + t.b;
  const int column = t.a + t.c;
  const int n = t.total();
  const auto probability = [&](int a) {
    return std::exp(LogChoose(column, a) + LogChoose(n - column, row - a) -
                    LogChoose(n, row));
  };
  const int low = std::max(0, row + column - n);
  const int high = std::min(row, column);
  // Tables as probable as the seen one count, up to rounding: as in R.
  const double seen = probability(t.a) * (1 + 1e-7);
  Fisher out{0.0, 0.0};
  for (int a = low; a <= high; ++a) {
    const double p = probability(a);
    if (a >= t.a) out.p_greater += p;
    if (p <= seen) out.p_two_sided += p;
  }
  out.p_greater = std::min(1.0, out.p_greater);
  out.p_two_sided = std::min(1.0, out.p_two_sided);
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

Equivalence EquivalenceZ(double value, double standard_error, double reference,
                         double margin, double alpha) {
  CheckEquivalence(standard_error, margin, alpha);
  Equivalence out;
  out.statistic_lower = (value - reference + margin) / standard_error;
  out.statistic_upper = (value - reference - margin) / standard_error;
  out.p_lower = core::NormalCdf(-out.statistic_lower);
  out.p_upper = core::NormalCdf(out.statistic_upper);
  out.equivalent = std::max(out.p_lower, out.p_upper) < alpha;
  return out;
}

Equivalence EquivalenceT(double mean, double sd, int n, double reference,
                         double margin, double alpha) {
  if (n < 2) {
    throw std::invalid_argument(
        fmt::format("n is {}; it must be at least 2", n));
  }
  const double standard_error = sd / std::sqrt(static_cast<double>(n));
  CheckEquivalence(standard_error, margin, alpha);
  Equivalence out;
  out.statistic_lower = (mean - reference + margin) / standard_error;
  out.statistic_upper = (mean - reference - margin) / standard_error;
  out.p_lower = StudentUpperTail(out.statistic_lower, n - 1);
  out.p_upper = StudentUpperTail(-out.statistic_upper, n - 1);
  out.equivalent = std::max(out.p_lower, out.p_upper) < alpha;
  return out;
}

double SmallestEquivalenceMargin(double value, double standard_error,
                                 double reference, double alpha) {
  CheckEquivalence(standard_error, 1.0, alpha);
  return std::abs(value - reference) - NormalQuantile(alpha) * standard_error;
}

}  // namespace touchdown::analysis
