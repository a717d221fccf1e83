#include "touchdown/analysis/statistics/binomial_regression.h"

#include <fmt/core.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "touchdown/analysis/statistics/special_functions.h"
#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Newton's steps until they no longer matter. A separated likelihood grows for
// ever: its steps do not shrink, so it is told by them.
constexpr int kMaxIterations = 200;
constexpr double kSmallStep = 1e-10;
constexpr int kHalvings = 40;
constexpr double kRounding = 1e-13;  // of sums of logarithms, relative
// The information of coefficients in units of their terms is singular where the
// least pivot is smaller than this share of the greatest.
constexpr double kSingular = 1e-14;

// ln P, d ln P/d eta, -d ln(1 - P)/d eta, P''/(2 P') and how fast that falls.
struct LinkAt {
  double log_p = 0.0;
  double log_q = 0.0;
  double up = 0.0;
  double down = 0.0;
  double half_curvature = 0.0;
  double fall = 0.0;
};

LinkAt At(Link link, double eta) {
  LinkAt out;
  if (link == Link::kProbit) {
    out.log_p = LogNormalCdf(eta);
    out.log_q = LogNormalCdf(-eta);
    // The density's logarithm, which does not underflow.
    const double log_density = LogNormalDensity(eta);
    out.up = std::exp(log_density - out.log_p);
    out.down = std::exp(log_density - out.log_q);
    out.half_curvature = -eta / 2;
    out.fall = 0.5;
  } else {
    const double tail = std::log1p(std::exp(-std::abs(eta)));
    out.log_p = std::min(eta, 0.0) - tail;
    out.log_q = -std::max(eta, 0.0) - tail;
    out.up = std::exp(out.log_q);
    out.down = std::exp(out.log_p);
    out.half_curvature = (out.up - out.down) / 2;
    out.fall = out.up * out.down;
  }
  return out;
}

double Eta(Link link, double p) {
  return link == Link::kProbit ? NormalQuantile(p) : std::log(p / (1 - p));
}

// A coefficient that is held.
struct Held {
  Index column = -1;
  double value = 0.0;
};

// The rows as a matrix whose columns are divided by their largest entry.
class Problem {
 public:
  Problem(std::span<const BinomialRow> rows, const RegressionOptions& options)
      : options_(options) {
    const std::size_t terms = rows.empty() ? 0 : rows.front().terms.size();
    const std::size_t first = options.intercept ? 1 : 0;
    x_.setOnes(static_cast<Index>(rows.size()),
               static_cast<Index>(terms + first));
    n_.resize(x_.rows());
    yes_.resize(x_.rows());
    for (Index i = 0; i < x_.rows(); ++i) {
      const BinomialRow& row = rows[static_cast<std::size_t>(i)];
      if (row.terms.size() != terms) {
        throw std::invalid_argument(
            fmt::format("terms: row {} has {}, the first has {}; must be equal",
                        i, row.terms.size(), terms));
      }
      core::RequirePositive("n", row.n);
      core::RequireInRange("yes", row.yes, 0.0, row.n);
      n_[i] = row.n;
      yes_[i] = row.yes;
      for (std::size_t j = 0; j < terms; ++j) {
        core::RequireFinite("terms", row.terms[j]);
        x_(i, static_cast<Index>(j + first)) = row.terms[j];
      }
    }
    scale_.setOnes(x_.cols());
    for (Index j = 0; j < x_.cols() && x_.rows() > 0; ++j) {
      const double largest = x_.col(j).cwiseAbs().maxCoeff();
      if (largest > 0.0) scale_[j] = largest;
      x_.col(j) /= scale_[j];
    }
  }

  struct State {
    VectorXd beta;  // of the scaled columns
    double log_likelihood = 0.0;
    double log_det = 0.0;  // of the information of the scaled columns
    MatrixXd information;
    VectorXd score;  // adjusted where asked for
    // About minus the score's derivative: the information, and where the score
    // is adjusted what the leverages add, which is as much again where there
    // are hardly more rows than coefficients.
    MatrixXd slope;
    bool singular = false;
  };

  State Look(const VectorXd& beta) const {
    State out;
    out.beta = beta;
    const VectorXd eta = x_ * beta;
    VectorXd weight(eta.size());
    VectorXd residual(eta.size());
    VectorXd half(eta.size());
    VectorXd fall(eta.size());
    for (Index i = 0; i < eta.size(); ++i) {
      const LinkAt at = At(options_.link, eta[i]);
      const double no = n_[i] - yes_[i];
      // 0 ln 0 is 0.
      if (yes_[i] > 0.0) out.log_likelihood += yes_[i] * at.log_p;
      if (no > 0.0) out.log_likelihood += no * at.log_q;
      weight[i] = n_[i] * at.up * at.down;
      residual[i] = yes_[i] * at.up - no * at.down;
      half[i] = at.half_curvature;
      fall[i] = at.fall;
    }
    out.information = x_.transpose() * weight.asDiagonal() * x_;
    const Eigen::LDLT<MatrixXd> solver(out.information);
    const VectorXd pivots = solver.vectorD();
    out.singular = x_.rows() == 0 || !pivots.allFinite() ||
                   !(pivots.minCoeff() > kSingular * pivots.maxCoeff());
    if (out.singular) return out;
    out.log_det = pivots.array().log().sum();
    if (options_.firth) {
      const MatrixXd solved = solver.solve(x_.transpose());
      for (Index i = 0; i < eta.size(); ++i) {
        const double leverage = weight[i] * x_.row(i).dot(solved.col(i));
        residual[i] += leverage * half[i];
        weight[i] += leverage * fall[i];
      }
    }
    out.score = x_.transpose() * residual;
    out.slope = x_.transpose() * weight.asDiagonal() * x_;
    return out;
  }

  // What is maximised; for Firth with another link than the logit there is no
  // such function, and steps are taken as they come.
  double Aim(const State& state) const {
    return state.log_likelihood + (options_.firth ? state.log_det / 2 : 0.0);
  }
  bool HasAim() const {
    return !options_.firth || options_.link == Link::kLogit;
  }

  // Newton's steps from `start`; `held` stays where it is.
  std::optional<State> Climb(VectorXd start, const Held& held = {},
                             RegressionStatus* why = nullptr) const {
    const auto fail = [&](RegressionStatus status) -> std::optional<State> {
      if (why != nullptr) *why = status;
      return std::nullopt;
    };
    if (held.column >= 0) start[held.column] = held.value * scale_[held.column];
    State state = Look(start);
    if (state.singular) return fail(RegressionStatus::kNotIdentified);
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
      MatrixXd slope = state.slope;
      VectorXd score = state.score;
      if (held.column >= 0) {
        slope.row(held.column).setZero();
        slope.col(held.column).setZero();
        slope(held.column, held.column) = 1.0;
        score[held.column] = 0.0;
      }
      const VectorXd step = slope.ldlt().solve(score);
      if (!step.allFinite()) return fail(RegressionStatus::kNoMaximum);
      if (step.norm() <= kSmallStep * (1.0 + state.beta.norm())) return state;
      // Near its top the aim is flat to rounding, where only the steps tell.
      const double floor =
          Aim(state) - kRounding * (1.0 + std::abs(Aim(state)));
      const auto good = [&](const State& next) {
        return !next.singular && (!HasAim() || Aim(next) >= floor);
      };
      double share = 1.0;
      State next = Look(state.beta + step);
      for (int i = 0; i < kHalvings && !good(next); ++i) {
        share /= 2;
        next = Look(state.beta + share * step);
      }
      if (!good(next)) return fail(RegressionStatus::kNoMaximum);
      state = std::move(next);
    }
    return fail(RegressionStatus::kNoMaximum);
  }

  double SaturatedLogLikelihood() const {
    double sum = 0.0;
    for (Index i = 0; i < n_.size(); ++i) {
      const double p = yes_[i] / n_[i];
      if (p > 0.0) sum += yes_[i] * std::log(p);
      if (p < 1.0) sum += (n_[i] - yes_[i]) * std::log1p(-p);
    }
    return sum;
  }

  VectorXd Zero() const { return VectorXd::Zero(x_.cols()); }
  const VectorXd& scale() const { return scale_; }

 private:
  RegressionOptions options_;
  MatrixXd x_;
  VectorXd scale_;
  VectorXd n_;
  VectorXd yes_;
};

VectorXd ScaledCoefficients(const Regression& fit, const VectorXd& scale) {
  VectorXd out(scale.size());
  for (Index i = 0; i < out.size(); ++i) {
    out[i] = fit.coefficients[static_cast<std::size_t>(i)] * scale[i];
  }
  return out;
}

// One end of {x: fall(x) <= quantile / 2}, going from `from`, where the fall is
// 0, by steps that grow.
double End(double from, double step, double half_quantile,
           const std::function<std::optional<double>(double)>& fall) {
  // Steps that grow: beyond them the interval has no end.
  constexpr int kMaxSteps = 60;
  double inside = from;
  double outside = from;
  for (int i = 0;; ++i) {
    if (i == kMaxSteps) return std::copysign(HUGE_VAL, step);
    outside = inside + step;
    const auto f = fall(outside);
    if (!f) return std::copysign(HUGE_VAL, step);
    if (*f > half_quantile) break;
    inside = outside;
    step *= 2;
  }
  for (int i = 0; i < 200 && inside != outside; ++i) {
    const double middle = inside + (outside - inside) / 2;
    if (middle == inside || middle == outside) break;
    const auto f = fall(middle);
    (f && *f <= half_quantile ? inside : outside) = middle;
  }
  return inside;
}

void RequireFound(const Regression& fit) {
  if (!fit.found()) {
    throw std::invalid_argument(
        "fit: it was not found; a profile needs its maximum");
  }
}

double HalfChiSquare(double level) {
  core::RequireInRange("level", level, 1e-12, 1.0 - 1e-12);
  const double z = NormalQuantile((1.0 + level) / 2);
  return z * z / 2;
}

}  // namespace

double Regression::StandardError(std::size_t i) const {
  return std::sqrt(covariance.at(i * coefficients.size() + i));
}

Regression FitRegression(std::span<const BinomialRow> rows,
                         const RegressionOptions& options) {
  const Problem problem(rows, options);
  Regression out;
  out.options = options;
  out.status = RegressionStatus::kNotIdentified;
  const auto state = problem.Climb(problem.Zero(), {}, &out.status);
  if (!state) return out;
  out.status = RegressionStatus::kFound;
  const VectorXd& scale = problem.scale();
  const Index k = scale.size();
  const MatrixXd inverse =
      state->information.ldlt().solve(MatrixXd::Identity(k, k));
  for (Index i = 0; i < k; ++i) {
    out.coefficients.push_back(state->beta[i] / scale[i]);
    for (Index j = 0; j < k; ++j) {
      out.covariance.push_back(inverse(i, j) / (scale[i] * scale[j]));
    }
  }
  out.log_likelihood = state->log_likelihood;
  out.penalised_log_likelihood =
      state->log_likelihood + state->log_det / 2 + scale.array().log().sum();
  out.deviance = 2 * (problem.SaturatedLogLikelihood() - state->log_likelihood);
  return out;
}

core::Interval CoefficientProfile(std::span<const BinomialRow> rows,
                                  const Regression& fit, std::size_t i,
                                  double level) {
  RequireFound(fit);
  if (i >= fit.coefficients.size()) {
    throw std::invalid_argument(
        fmt::format("i: {}; must be below {}", i, fit.coefficients.size()));
  }
  const Problem problem(rows, fit.options);
  if (!problem.HasAim()) {
    throw std::invalid_argument(
        "fit: Firth's probit has no penalised likelihood; must be a logit, or "
        "without firth");
  }
  VectorXd start = ScaledCoefficients(fit, problem.scale());
  const double top = problem.Aim(problem.Look(start));
  const auto fall = [&](double value) -> std::optional<double> {
    const auto state = problem.Climb(start, {static_cast<Index>(i), value});
    if (!state) return std::nullopt;
    return top - problem.Aim(*state);
  };
  const double half = HalfChiSquare(level);
  const double step = fit.StandardError(i);
  const double from = fit.coefficients[i];
  return {End(from, -step, half, fall), End(from, step, half, fall)};
}

std::optional<EffectiveLevel> FindEffectiveLevel(const Regression& fit,
                                                 double p, std::size_t term) {
  if (!(p > 0.0 && p < 1.0)) core::Refuse("p", p, "above 0 and below 1");
  if (!fit.options.intercept || term == 0) {
    throw std::invalid_argument(
        "term: the intercept or none; must be a term beside an intercept");
  }
  if (!fit.found()) return std::nullopt;
  const std::size_t k = fit.coefficients.size();
  if (term >= k) {
    throw std::invalid_argument(
        fmt::format("term: {}; must be below {}", term, k));
  }
  const double slope = fit.coefficients[term];
  if (!(slope > 0.0)) return std::nullopt;
  const double v00 = fit.covariance[0];
  const double v01 = fit.covariance[term];
  const double v11 = fit.covariance[term * k + term];
  EffectiveLevel out;
  out.value = (Eta(fit.options.link, p) - fit.coefficients[0]) / slope;
  const double x = out.value;
  const double variance = v00 + 2 * x * v01 + x * x * v11;
  out.u = std::sqrt(variance) / slope;
  const double z = core::kNormal975;
  out.wald95 = {x - z * out.u, x + z * out.u};
  const double g = z * z * v11 / (slope * slope);
  if (g < 1.0) {
    const double centre = x + g / (1 - g) * (x + v01 / v11);
    const double half = z / (slope * (1 - g)) *
                        std::sqrt(variance - g * (v00 - v01 * v01 / v11));
    out.fieller95 = core::Interval{centre - half, centre + half};
  }
  return out;
}

core::Interval MedianLevelProfile(std::span<const BinomialRow> rows,
                                  const Regression& fit, double level) {
  RequireFound(fit);
  const auto found = FindEffectiveLevel(fit);
  if (!found || fit.coefficients.size() != 2 || fit.options.firth) {
    throw std::invalid_argument(
        "fit: must have one term with a positive slope, and no penalty");
  }
  RegressionOptions options = fit.options;
  options.intercept = false;
  const auto fall = [&](double x) -> std::optional<double> {
    std::vector<BinomialRow> moved(rows.begin(), rows.end());
    for (BinomialRow& row : moved) row.terms[0] -= x;
    const Problem problem(moved, options);
    const auto state = problem.Climb(problem.Zero());
    // The slope does not turn: at 0 every P is 1/2.
    if (!state || state->beta[0] < 0.0) {
      return fit.log_likelihood - problem.Look(problem.Zero()).log_likelihood;
    }
    return fit.log_likelihood - state->log_likelihood;
  };
  const double half = HalfChiSquare(level);
  return {End(found->value, -found->u, half, fall),
          End(found->value, found->u, half, fall)};
}

}  // namespace touchdown::analysis
