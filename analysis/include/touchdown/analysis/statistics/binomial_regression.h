// Regression of yes/no answers on one or more terms: what textbooks and other
// programs fit, as a cross-check of the posterior (boundary_fit.h), never in
// its place. STATISTICS.md says why.
//
// eta = b0 + b1 x1 + ...; P(yes) = Phi(eta) (probit) or 1/(1 + exp(-eta))
// (logit). Errors in the terms are left out.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "touchdown/core/estimate.h"

namespace touchdown::analysis {

enum class Link { kProbit, kLogit };

// `yes` of `n` trials at the same terms.
struct BinomialRow {
  std::vector<double> terms;  // as many in every row; without the intercept
  double n = 1.0;
  double yes = 0.0;
};

struct RegressionOptions {
  Link link = Link::kProbit;
  bool intercept = true;
  // Firth (1993): the score is adjusted so that the first-order bias of the
  // estimate vanishes (for other links than the logit by Kosmidis and Firth
  // 2009, Biometrika 96, Eq. 13). It exists for separated data too.
  bool firth = false;
};

enum class RegressionStatus {
  kFound,
  kNoMaximum,      // separated: the likelihood grows as coefficients do
  kNotIdentified,  // fewer distinct terms than coefficients
};

struct Regression {
  RegressionStatus status = RegressionStatus::kNotIdentified;
  RegressionOptions options;         // that it was made with
  std::vector<double> coefficients;  // the intercept first; empty unless found
  // Inverse of the expected information, row by row.
  std::vector<double> covariance;
  // sum of yes ln P + (n - yes) ln(1 - P), without binomial coefficients.
  double log_likelihood = 0.0;
  // That plus half the logarithm of the information's determinant: Jeffreys'
  // prior. What Firth's estimate maximises with the logit link.
  double penalised_log_likelihood = 0.0;
  double deviance = 0.0;  // twice the distance to the saturated model's

  bool found() const { return status == RegressionStatus::kFound; }
  // Standard error of a coefficient; 0 <= i < coefficients.size().
  double StandardError(std::size_t i) const;
};

// Throws std::invalid_argument where rows differ in their number of terms, a
// number is not finite, n <= 0, or yes is not from 0 to n.
Regression FitRegression(std::span<const BinomialRow> rows,
                         const RegressionOptions& options = {});

// Where 2 (max - profile) = the quantile of chi^2 with one degree of freedom;
// with `firth` of the penalised likelihood (Heinze and Schemper 2002). An end
// that is not reached is infinite. `i`: which coefficient. Throws
// std::invalid_argument where the fit was not found, `i` is none of its, or
// `firth` is asked of another link than the logit, whose adjusted score is
// the gradient of nothing.
core::Interval CoefficientProfile(std::span<const BinomialRow> rows,
                                  const Regression& fit, std::size_t i,
                                  double level = 0.95);

// The value of one term at which P = p, the other terms being 0.
struct EffectiveLevel {
  double value = std::numeric_limits<double>::quiet_NaN();
  double u = std::numeric_limits<double>::quiet_NaN();  // delta method
  core::Interval wald95;                                // value -+ 1.96 u
  std::optional<core::Interval> fieller95;  // absent where it is unbounded
};

// `term`: which coefficient is that term's slope. Nothing where the fit was not
// found or the slope is not positive. Fieller (1954) as in Finney, Probit
// Analysis, 4.6: bounded where g = z^2 var(b)/b^2 < 1. Throws
// std::invalid_argument unless 0 < p < 1, there is an intercept and `term` is a
// coefficient after it.
std::optional<EffectiveLevel> FindEffectiveLevel(const Regression& fit,
                                                 double p = 0.5,
                                                 std::size_t term = 1);

// Likelihood-ratio interval of the level at which P = 1/2, of a fit with one
// term; an end that is not reached is infinite. Throws like CoefficientProfile,
// and where there is another number of terms than one.
core::Interval MedianLevelProfile(std::span<const BinomialRow> rows,
                                  const Regression& fit, double level = 0.95);

}  // namespace touchdown::analysis
