#include "touchdown/analysis/boundary_study.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace touchdown::analysis {
namespace {

constexpr double kTheoryCoverage = 2.0;           // U = 2 u
constexpr double kNormal95 = 1.6448536269514722;  // half of the 90 % interval

// The half-width at which the rule decides: the 90 % interval inside the
// margin, or the 95 % interval outside margin + U.
int TrialsToDecide(const BoundaryPosterior& posterior,
                   const TheoryComparison& comparison,
                   const StudyOptions& options) {
  const double off = std::abs(comparison.difference_rad);
  const double far =
      options.margin_rad + kTheoryCoverage * comparison.theory.u_rad;
  const double to_confirm =
      (options.margin_rad - off) * core::kNormal975 / kNormal95;
  // On the edge between the two no number of trials decides: a hundredth of the
  // margin stands for that.
  const double target =
      std::max({to_confirm, off - far, options.margin_rad / 100});
  std::mt19937_64 engine(options.next.forecast_seed);
  return ForecastTrials(posterior, {target, options.next.set_u_rad}, engine);
}

TheoryComparison Compare(std::span<const Observation> observations,
                         const BoundaryPosterior& posterior,
                         const TheoryBoundary& theory, bool declared,
                         const StudyOptions& options) {
  TheoryComparison out;
  out.theory = theory;
  out.declared = declared;
  out.agreement = CompareWithTheory(observations, theory, options.agreement);
  const double value = theory.boundary_rad;
  const double margin = options.margin_rad;
  out.difference_rad = posterior.median_rad - value;
  out.p_below = ProbabilityBelow(posterior, value);
  out.p_within = ProbabilityWithin(posterior, value, margin);
  out.e_n = NormalizedError(
      posterior.median_rad,
      (posterior.interval95_rad.high - posterior.interval95_rad.low) / 2, value,
      kTheoryCoverage * theory.u_rad);
  out.p_too_low = ProbabilityBelow(posterior, value - margin);
  out.p_too_high = 1.0 - ProbabilityBelow(posterior, value + margin);
  out.smallest_margin_rad = SmallestPassingMargin(posterior, value);

  if (!declared) {
    out.judgement.verdict = core::AbsentBecause(
        "only the theory declared before the first trial gets a verdict");
  } else if (Count(observations).decided() == 0) {
    out.judgement.verdict = core::AbsentBecause("no decided trial");
  } else {
    out.judgement = Judge({posterior.interval90_rad, posterior.interval95_rad},
                          theory, margin, options.origin);
  }
  if (!out.judgement.verdict) {
    out.judgement.reason = out.judgement.verdict.error().reason;
  }

  if (out.judgement.verdict == core::Verdict::kInconclusive) {
    out.trials_to_decide = TrialsToDecide(posterior, out, options);
  }

  const ConfusionMatrix& m = out.agreement.deciding;
  if (m.total() == 0) return out;
  out.wilson95 = WilsonInterval(m.right(), m.total());
  out.clopper_pearson95 = ClopperPearsonInterval(m.right(), m.total());
  const int counts[] = {m.slide_slide, m.slide_bounce, m.bounce_slide,
                        m.bounce_bounce};
  if (const Kappa kappa = CohenKappa(counts, 2); !std::isnan(kappa.kappa)) {
    out.kappa = kappa;
  }
  const double matthews = MatthewsCorrelation(
      {m.slide_slide, m.slide_bounce, m.bounce_slide, m.bounce_bounce});
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
        [](const auto& a, const auto& b) { return a.u_rad < b.u_rad; });
    out.least_u_rad = least->u_rad;
    out.greatest_u_rad = greatest->u_rad;
  }
  out.posterior = FitBoundary(observations, options.fit);
  out.likelihood = ProfileLikelihood(
      observations,
      {options.fit.low_rad, options.fit.high_rad, options.fit.scatter_low_rad,
       options.fit.scatter_high_rad});
  out.margin_rad = options.margin_rad;
  if (options.declared) {
    out.theories.push_back(
        Compare(observations, out.posterior, *options.declared, true, options));
  }
  for (const TheoryBoundary& theory : options.others) {
    out.theories.push_back(
        Compare(observations, out.posterior, theory, false, options));
  }
  out.next = ChooseNextAngle(out.posterior, out.counts.total(), options.next);
  return out;
}

}  // namespace touchdown::analysis
