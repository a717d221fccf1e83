#include "touchdown/analysis/statistics/probit_fit.h"

#include <algorithm>
#include <cmath>

#include "touchdown/analysis/statistics/special_functions.h"

namespace touchdown::analysis {
namespace {

// Newton's steps until they no longer matter. A separated likelihood grows for
// ever: its steps do not shrink, so it is told by them.
constexpr int kMaxIterations = 200;
constexpr double kSmallStep = 1e-10;
constexpr int kHalvings = 40;
constexpr double kRounding = 1e-13;  // of sums of logarithms, relative
// The information is singular where its second pivot is smaller than this share
// of the first.
constexpr double kSingular = 1e-14;

// The likelihood of P(bounce) = Phi(beta_0 + beta_1 x / scale), and the
// derivatives of its logarithm.
struct State {
  double beta[2] = {0.0, 0.0};
  double log_likelihood = 0.0;
  double score[2] = {0.0, 0.0};
  // Of the information, and their determinant.
  double i00 = 0.0;
  double i01 = 0.0;
  double i11 = 0.0;
  double determinant = 0.0;
  bool singular = false;
};

State Look(std::span<const Observation> trials, double scale, double beta_0,
           double beta_1) {
  State out;
  out.beta[0] = beta_0;
  out.beta[1] = beta_1;
  for (const Observation& o : trials) {
    const double x = o.angle_rad / scale;
    const double eta = beta_0 + beta_1 * x;
    const double log_p = LogNormalCdf(eta);
    const double log_q = LogNormalCdf(-eta);
    // d ln P / d eta and -d ln(1 - P) / d eta by the density's logarithm, which
    // does not underflow.
    const double log_density = LogNormalDensity(eta);
    const double up = std::exp(log_density - log_p);
    const double down = std::exp(log_density - log_q);
    const bool bounced = o.outcome == Outcome::kBounce;
    const double residual = bounced ? up : -down;
    const double weight = up * down;
    out.log_likelihood += bounced ? log_p : log_q;
    out.score[0] += residual;
    out.score[1] += residual * x;
    out.i00 += weight;
    out.i01 += weight * x;
    out.i11 += weight * x * x;
  }
  out.determinant = out.i00 * out.i11 - out.i01 * out.i01;
  const double greater = std::max(out.i00, out.i11);
  out.singular = !(out.determinant > kSingular * greater * greater);
  return out;
}

}  // namespace

std::optional<ProbitFit> FitProbit(std::span<const Observation> trials) {
  double scale = 0.0;  // angles of about 1
  for (const Observation& o : trials) {
    scale = std::max(scale, std::abs(o.angle_rad));
  }
  if (!(scale > 0.0)) return std::nullopt;
  State state = Look(trials, scale, 0.0, 0.0);
  if (state.singular) return std::nullopt;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const auto& [s0, s1] = state.score;
    const double step_0 = (state.i11 * s0 - state.i01 * s1) / state.determinant;
    const double step_1 = (state.i00 * s1 - state.i01 * s0) / state.determinant;
    const double size = std::hypot(step_0, step_1);
    if (!std::isfinite(size)) return std::nullopt;
    if (size <= kSmallStep * (1.0 + std::hypot(state.beta[0], state.beta[1]))) {
      const double slope = state.beta[1] / scale;
      if (!(slope > 0.0)) return std::nullopt;
      return ProbitFit{-state.beta[0] / slope, 1.0 / slope};
    }
    // Near its top the likelihood is flat to rounding, where only the steps
    // tell.
    const double floor = state.log_likelihood -
                         kRounding * (1.0 + std::abs(state.log_likelihood));
    const auto good = [&](const State& next) {
      return !next.singular && next.log_likelihood >= floor;
    };
    const auto look = [&](double share) {
      return Look(trials, scale, state.beta[0] + share * step_0,
                  state.beta[1] + share * step_1);
    };
    double share = 1.0;
    State next = look(share);
    for (int i = 0; i < kHalvings && !good(next); ++i) {
      share /= 2;
      next = look(share);
    }
    if (!good(next)) return std::nullopt;
    state = next;
  }
  return std::nullopt;
}

}  // namespace touchdown::analysis
