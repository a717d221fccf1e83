#include "touchdown/analysis/statistics/verdict.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "statistics/likelihood.h"
#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

using core::kDegree;
using core::Verdict;

// Ratios beyond this are printed as "more than a million".
constexpr double kMostPrinted = 13.8;

// "fits 36 times worse"
std::string Worse(double log_ratio) {
  if (log_ratio > kMostPrinted) return "more than a million times worse";
  return fmt::format("{:.3g} times worse", std::exp(std::max(log_ratio, 0.0)));
}

std::string Range(double value_rad, double width_rad) {
  return fmt::format("{:.2f} +- {:.2f} deg", value_rad / kDegree,
                     width_rad / kDegree);
}

Judgement Inconclusive(std::string reason) {
  Judgement out;
  out.verdict = Verdict::kInconclusive;
  out.reason = std::move(reason);
  return out;
}

// Why the trials could not confirm, whatever the likelihood says; empty where
// they could.
std::string WhyNotToConfirm(const VerdictBasis& basis,
                            const TheoryBoundary& theory, double margin_rad,
                            const VerdictOptions& options) {
  const double theory_u = kTheoryCoverage * theory.u_rad;
  if (theory_u >= options.most_theory_share * margin_rad && theory_u > 0.0) {
    return fmt::format(
        "the theory is too vague for this margin: its U = {:.2f} deg is not "
        "below half of {:.2f} deg",
        theory_u / kDegree, margin_rad / kDegree);
  }
  if (basis.counts.bounce == 0 || basis.counts.not_bounce == 0) {
    return "a confirmation needs both bounces and slides";
  }
  if (basis.span_rad < options.least_span_margins * margin_rad) {
    return fmt::format(
        "a confirmation needs angles that span {:.2f} deg, and these span "
        "{:.2f}",
        options.least_span_margins * margin_rad / kDegree,
        basis.span_rad / kDegree);
  }
  return "";
}

}  // namespace

VerdictBasis MakeVerdictBasis(std::span<const Observation> observations,
                              const BoundaryPosterior& posterior,
                              const Evidence& evidence,
                              const TheoryBoundary& theory, double margin_rad) {
  VerdictBasis out;
  out.counts = Count(observations);
  out.status = posterior.status;
  out.evidence = evidence;
  bool any = false;
  double least = 0.0;
  double greatest = 0.0;
  for (const Observation& o : observations) {
    if (o.outcome == Outcome::kUndecided) continue;
    least = any ? std::min(least, o.angle_rad) : o.angle_rad;
    greatest = any ? std::max(greatest, o.angle_rad) : o.angle_rad;
    any = true;
  }
  out.span_rad = greatest - least;
  const double value = theory.boundary_rad;
  const double far = margin_rad + kTheoryCoverage * theory.u_rad;
  out.p_below = CumulativeProbability(posterior, value - margin_rad);
  out.p_above = 1.0 - CumulativeProbability(posterior, value + margin_rad);
  out.p_far_below = CumulativeProbability(posterior, value - far);
  out.p_far_above = 1.0 - CumulativeProbability(posterior, value + far);
  return out;
}

double LogRatioNeeded(int trials, const VerdictOptions& options) {
  const double more = static_cast<double>(trials) / options.looks;
  return options.log_ratio + (more > 1.0 ? std::log(more) / 2 : 0.0);
}

Judgement Judge(const VerdictBasis& basis, const TheoryBoundary& theory,
                double margin_rad, core::Origin origin,
                const VerdictOptions& options) {
  core::RequirePositive("margin_rad", margin_rad);
  core::RequireFinite("theory boundary_rad", theory.boundary_rad);
  core::RequireNotNegative("theory u_rad", theory.u_rad);
  if (origin == core::Origin::kSimulated) {
    Judgement out;
    out.verdict = core::AbsentBecause(
        "simulated trials yield no verdict on a theory: they test the "
        "software");
    out.reason = out.verdict.error().reason;
    return out;
  }
  const int decided = basis.counts.decided();
  if (decided == 0) {
    Judgement out;
    out.verdict = core::AbsentBecause("no decided trial");
    out.reason = out.verdict.error().reason;
    return out;
  }
  if (decided < options.fewest_trials) {
    return Inconclusive(
        fmt::format("{} decided trial{}; a verdict needs at least {}", decided,
                    decided == 1 ? "" : "s", options.fewest_trials));
  }
  if (basis.status == DataStatus::kReversed) {
    return Inconclusive(
        "bounces lie lower than slides, against what any boundary allows");
  }
  const Evidence& e = basis.evidence;
  const double value = theory.boundary_rad;
  const double far = margin_rad + kTheoryCoverage * theory.u_rad;
  if (!std::isfinite(e.log_near)) {
    return Inconclusive(fmt::format(
        "{} lies outside the angles at which a boundary was looked for",
        Range(value, far)));
  }

  // Contradicted: on which side, and by how much the best boundary near the
  // theory fits worse.
  const bool above = basis.p_far_above >= basis.p_far_below;
  const double p_far = above ? basis.p_far_above : basis.p_far_below;
  const double against =
      (above ? e.log_far_above : e.log_far_below) - e.log_near;
  const double needed = LogRatioNeeded(decided, options);
  const bool posterior_far = p_far >= 1.0 - options.tail_to_contradict;
  if (posterior_far && against >= needed) {
    Judgement out;
    out.verdict = Verdict::kContradicted;
    out.reason = fmt::format(
        "the 95 % interval lies {} {}, and whatever the scatter, the best "
        "boundary in there fits {} than the best outside",
        above ? "above" : "below", Range(value, far), Worse(against));
    return out;
  }

  // Confirmed.
  const std::string obstacle =
      WhyNotToConfirm(basis, theory, margin_rad, options);
  const double for_it = e.log_within - std::max(e.log_below, e.log_above);
  const bool posterior_within = basis.p_below <= options.tail_to_confirm &&
                                basis.p_above <= options.tail_to_confirm;
  if (posterior_within && for_it >= needed && obstacle.empty()) {
    Judgement out;
    out.verdict = Verdict::kConfirmed;
    out.reason = fmt::format(
        "the 90 % interval lies within {}, and whatever the scatter, the best "
        "boundary outside fits {} than the best within",
        Range(value, margin_rad), Worse(for_it));
    return out;
  }

  if (posterior_far) {
    return Inconclusive(fmt::format(
        "the 95 % interval lies outside {}, but with another scatter a "
        "boundary in there fits only {} (a contradiction needs {:.3g})",
        Range(value, far), Worse(against), std::exp(needed)));
  }
  if (!obstacle.empty()) return Inconclusive(obstacle);
  if (posterior_within) {
    return Inconclusive(fmt::format(
        "the 90 % interval lies within {}, but with another scatter a "
        "boundary outside fits only {} (a confirmation needs {:.3g})",
        Range(value, margin_rad), Worse(for_it), std::exp(needed)));
  }
  return Inconclusive(
      fmt::format("the boundary may lie within {} and outside it",
                  Range(value, margin_rad)));
}

DecidingShot FindDecidingShot(const BoundaryPosterior& posterior,
                              const TheoryBoundary& theory, double margin_rad,
                              core::Interval candidates, double set_u_rad) {
  core::RequirePositive("margin_rad", margin_rad);
  core::RequireNotNegative("set_u_rad", set_u_rad);
  // rad between candidate angles. Smaller costs time in proportion. Not
  // studied.
  constexpr double kStep_rad = 0.5 * kDegree;
  // Outcomes are forecast under fewer cells than the posterior has: the ones
  // without weight are passed over.
  constexpr double kNegligible = 1e-8;
  const BoundaryGrid& grid = posterior.grid;
  const std::size_t m = grid.scatter_rad.size();
  std::vector<double> inverse;
  for (const double s : grid.scatter_rad) {
    inverse.push_back(1.0 / std::hypot(s, set_u_rad));
  }
  const auto entropy = [](double p) {
    if (p <= 0.0 || p >= 1.0) return 0.0;
    return -p * std::log2(p) - (1.0 - p) * std::log2(1.0 - p);
  };
  DecidingShot best{candidates.low, 0.0};
  const auto first = std::llround(std::ceil(candidates.low / kStep_rad));
  const auto last = std::llround(std::floor(candidates.high / kStep_rad));
  for (auto i = first; i <= last; ++i) {
    const double angle = static_cast<double>(i) * kStep_rad;
    double weight[2] = {0.0, 0.0};   // outside, within
    double bounces[2] = {0.0, 0.0};  // P(bounce and there)
    for (std::size_t k = 0; k < grid.weight.size(); ++k) {
      const double w = grid.weight[k];
      if (w < kNegligible) continue;
      const double theta = grid.angle_rad[k / m];
      const int within =
          std::abs(theta - theory.boundary_rad) <= margin_rad ? 1 : 0;
      weight[within] += w;
      bounces[within] += w * FastNormalCdf((angle - theta) * inverse[k % m]);
    }
    const double all = weight[0] + weight[1];
    if (!(all > 0.0)) continue;
    double information = entropy((bounces[0] + bounces[1]) / all);
    for (const int side : {0, 1}) {
      if (weight[side] > 0.0) {
        information -=
            weight[side] / all * entropy(bounces[side] / weight[side]);
      }
    }
    if (information > best.information_bits + 1e-9) best = {angle, information};
  }
  return best;
}

}  // namespace touchdown::analysis
