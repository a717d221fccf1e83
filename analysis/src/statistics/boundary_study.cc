#include "touchdown/analysis/statistics/boundary_study.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "touchdown/analysis/statistics/set_angles.h"

namespace touchdown::analysis {
namespace {

// The half-width of the 95 % interval at which the rule decides: that of a
// normal likelihood whose ratio at the nearer edge is the one that is needed.
int TrialsToDecide(const BoundaryPosterior& posterior,
                   const TheoryComparison& comparison,
                   const StudyOptions& options) {
  const double off = std::abs(comparison.difference_rad);
  const double far =
      options.margin_rad + kTheoryCoverage * comparison.theory.u_rad;
  const auto half_width = [&](double distance) {
    return distance * core::kNormal975 /
           std::sqrt(2.0 * options.verdict.log_ratio);
  };
  // On the edge between the two no number of trials decides: a hundredth of the
  // margin stands for that.
  const double target =
      std::max({half_width(options.margin_rad - off), half_width(off - far),
                options.margin_rad / 100});
  // An error that all trials share is not made smaller by more of them.
  if (target < core::kNormal975 * posterior.common_u_rad) return kNeverDecided;
  std::mt19937_64 engine(options.next.forecast_seed);
  const int by_width =
      ForecastTrials(posterior, {target, options.next.set_u_rad}, engine);
  const int decided = comparison.basis.counts.decided();
  return std::max(by_width, options.verdict.fewest_trials - decided);
}

// `fitted` are the observations that the posterior was made of.
TheoryComparison Compare(std::span<const Observation> observations,
                         std::span<const Observation> fitted,
                         const BoundaryPosterior& posterior,
                         const TheoryBoundary& theory, bool declared,
                         const StudyOptions& options) {
  TheoryComparison out;
  out.theory = theory;
  out.declared = declared;
  out.agreement = CompareWithTheory(observations, theory);
  const double value = theory.boundary_rad;
  const double margin = options.margin_rad;
  out.difference_rad = posterior.median_rad - value;
  out.p_below = CumulativeProbability(posterior, value);
  out.p_within = MarginProbability(posterior, value, margin);
  out.e_n = NormalizedError(
      posterior.median_rad,
      (posterior.interval95_rad.high - posterior.interval95_rad.low) / 2, value,
      kTheoryCoverage * theory.u_rad);
  out.p_too_low = CumulativeProbability(posterior, value - margin);
  out.p_too_high = 1.0 - CumulativeProbability(posterior, value + margin);
  out.smallest_margin_rad = SmallestPassingMargin(posterior, value);

  if (!declared) {
    out.judgement.verdict = core::AbsentBecause(
        "only the theory declared before the first trial gets a verdict");
  } else {
    EvidenceOptions evidence;
    evidence.low_rad = options.fit.low_rad;
    evidence.high_rad = options.fit.high_rad;
    evidence.scatter_low_rad = options.fit.scatter_low_rad;
    evidence.scatter_high_rad = options.fit.scatter_high_rad;
    evidence.lapse = posterior.lapse;
    evidence.bin_above = options.fit.bin_above;
    evidence.bin_width_rad = options.fit.bin_width_rad;
    out.basis = MakeVerdictBasis(
        observations, posterior,
        WeighEvidence(fitted, theory, margin, evidence), theory, margin);
    out.judgement =
        Judge(out.basis, theory, margin, options.origin, options.verdict);
  }
  if (!out.judgement.verdict) {
    out.judgement.reason = out.judgement.verdict.error().reason;
  }

  if (out.judgement.verdict == core::Verdict::kInconclusive) {
    out.trials_to_decide = TrialsToDecide(posterior, out, options);
    out.deciding =
        FindDecidingShot(posterior, theory, margin, options.next.feasible_rad,
                         options.next.set_u_rad);
  }

  const ConfusionMatrix& m = out.agreement.deciding;
  if (m.total() == 0) return out;
  out.wilson95 = WilsonInterval(m.right(), m.total());
  out.clopper_pearson95 = ClopperPearsonInterval(m.right(), m.total());
  const TwoByTwo counts{m.slide_slide, m.slide_bounce, m.bounce_slide,
                        m.bounce_bounce};
  if (const CohensKappa kappa = CohenKappa(counts); !std::isnan(kappa.kappa)) {
    out.kappa = kappa;
  }
  const double matthews = MatthewsCorrelation(counts);
  if (!std::isnan(matthews)) out.matthews = matthews;
  return out;
}

}  // namespace

BoundaryStudy StudyBoundary(std::span<const Observation> observations,
                            const StudyOptions& options) {
  BoundaryStudy out;
  out.counts = Count(observations);
  out.bracket = FindBracket(observations);
  if (!observations.empty()) {
    const auto [least, greatest] = std::minmax_element(
        observations.begin(), observations.end(),
        [](const auto& a, const auto& b) { return TotalU(a) < TotalU(b); });
    out.least_u_rad = TotalU(*least);
    out.greatest_u_rad = TotalU(*greatest);
  }
  SetAngleUse use = UseSetAngles(observations, {options.next.set_u_rad});
  const std::vector<Observation>& fitted = use.observations;
  out.used_set_angles = use.used;
  out.set_within_rad = use.within_rad;
  out.set_between_rad = use.between_rad;
  out.posterior = FitBoundary(fitted, options.fit);
  // What kind of data these are is said of the angles as they were measured.
  out.posterior.status = Classify(observations);
  const bool share_errors =
      std::any_of(fitted.begin(), fitted.end(),
                  [](const Observation& o) { return o.common_u_rad > 0.0; });
  out.likelihood = share_errors
                       ? ProfileOfPosterior(out.posterior)
                       : ProfileLikelihood(
                             fitted, {options.fit.low_rad, options.fit.high_rad,
                                      options.fit.scatter_low_rad,
                                      options.fit.scatter_high_rad});
  out.margin_rad = options.margin_rad;
  if (options.declared) {
    out.theories.push_back(Compare(observations, fitted, out.posterior,
                                   *options.declared, true, options));
  }
  for (const TheoryBoundary& theory : options.others) {
    out.theories.push_back(
        Compare(observations, fitted, out.posterior, theory, false, options));
  }
  out.next = ChooseNextAngle(out.posterior, out.counts.total(), options.next);
  return out;
}

}  // namespace touchdown::analysis
