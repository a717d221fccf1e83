// The verdict on a declared theory: one rule that holds for every design and at
// every look.
//
//   contradicted  the boundary lies outside value +- (margin + U), U = 2 u of
//                 the theory
//   confirmed     the boundary lies within value +- margin, and U is below half
//                 the margin
//   inconclusive  otherwise
//
// Each claim must be borne out twice. By the posterior: the equal-tail 95 %
// interval lies outside (90 %: within). And by the likelihood, every scatter
// allowed and no prior (evidence.h): the best boundary that the claim denies
// fits worse by a generalised likelihood ratio that was chosen by simulation,
// so that over designs, scatters, distances and common errors at most 5 of 100
// campaigns ever see a false verdict, though they look after each of 60 trials
// (STATISTICS.md; `./dev bench verdicts`). Simulated trials yield no verdict:
// they test the software, not the theory.
#pragma once

#include <span>
#include <string>

#include "touchdown/analysis/statistics/agreement.h"
#include "touchdown/analysis/statistics/boundary_fit.h"
#include "touchdown/analysis/statistics/evidence.h"
#include "touchdown/analysis/statistics/observation.h"
#include "touchdown/core/expected.h"
#include "touchdown/core/units.h"
#include "touchdown/core/words.h"

namespace touchdown::analysis {

struct VerdictOptions {
  // No verdict with fewer decided trials.
  int fewest_trials = kFewTrials;
  // Least log likelihood ratio of the best boundary within the claim to the
  // best that it denies, scatter free: the 99.2 % interval of the profile lies
  // within the claim. Chosen by simulation: with 3.0 the worst cell (staircase,
  // scatter 1 deg, truth 1.1 margins off) has 5.8 % false verdicts in 60 looks,
  // with 3.5 none has 5 %. It costs a confirmation 1 trial of 16 at a scatter
  // of a third of the margin (the posterior is stricter there), 13 of 40 at 1.
  double log_ratio = 3.5;
  // Beyond this number of trials it grows by half of ln(n / looks), as the
  // bound of a mixture of likelihoods does: more looks are more chances.
  int looks = 60;
  // Greatest tails of the posterior beyond the claim, each side: the 90 % and
  // 95 % equal-tail intervals.
  double tail_to_confirm = 0.05;
  double tail_to_contradict = 0.025;
  // A confirmation needs both outcomes, and angles that differ by this many
  // margins at least: trials at one angle tell the side and not the distance.
  double least_span_margins = 2.0;
  // A theory whose U is more than this share of the margin is too vague to be
  // confirmed.
  double most_theory_share = 0.5;
};

// What a verdict rests on.
struct VerdictBasis {
  Counts counts;
  DataStatus status = DataStatus::kNoTrials;
  double span_rad = 0.0;  // greatest minus least angle of decided trials
  Evidence evidence;
  // Of the posterior: theta below value - margin, above value + margin, and
  // the same with margin + U.
  double p_below = 0.0;
  double p_above = 0.0;
  double p_far_below = 0.0;
  double p_far_above = 0.0;
};

// `evidence` must be of the same observations, theory and margin.
VerdictBasis MakeVerdictBasis(std::span<const Observation> observations,
                              const BoundaryPosterior& posterior,
                              const Evidence& evidence,
                              const TheoryBoundary& theory, double margin_rad);

// A verdict, or why there is none, and what it rests on in words.
struct Judgement {
  core::Expected<core::Verdict> verdict =
      core::AbsentBecause("nothing was compared");
  std::string reason;
};

// Throws std::invalid_argument unless margin > 0 and finite.
Judgement Judge(const VerdictBasis& basis, const TheoryBoundary& theory,
                double margin_rad, core::Origin origin,
                const VerdictOptions& options = {});

// The log likelihood ratio that a verdict after so many decided trials needs.
double LogRatioNeeded(int trials, const VerdictOptions& options = {});

// The angle whose outcome tells most of whether the boundary lies within the
// margin: greatest mutual information between the two under the posterior,
// in bits, over `candidates`; ties to the lower angle. `set_u_rad` is the
// repeatability of the ejector.
struct DecidingShot {
  double angle_rad = 0.0;
  double information_bits = 0.0;
};
DecidingShot FindDecidingShot(const BoundaryPosterior& posterior,
                              const TheoryBoundary& theory, double margin_rad,
                              core::Interval candidates, double set_u_rad);

}  // namespace touchdown::analysis
