// Everything that one group of trials says of its boundary angle, in the order
// in which it should be read.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "touchdown/analysis/statistics/agreement.h"
#include "touchdown/analysis/statistics/agreement_statistics.h"
#include "touchdown/analysis/statistics/boundary_fit.h"
#include "touchdown/analysis/statistics/likelihood_profile.h"
#include "touchdown/analysis/statistics/next_angle.h"
#include "touchdown/analysis/statistics/observation.h"
#include "touchdown/analysis/statistics/verdict.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/words.h"

namespace touchdown::analysis {

// A forecast of so many trials means: not by more trials of this kind.
inline constexpr int kNeverDecided = 1'000'000;

struct StudyOptions {
  BoundaryFitOptions fit;
  NextAngleOptions next;
  // The theory declared before the first trial: the only one with a verdict.
  std::optional<TheoryBoundary> declared;
  double margin_rad = 1.0 * core::kDegree;
  VerdictOptions verdict;
  // Boundaries shown beside it, for information.
  std::vector<TheoryBoundary> others;
  core::Origin origin = core::Origin::kRecorded;
};

// A theory's boundary beside the trials.
struct TheoryComparison {
  TheoryBoundary theory;
  bool declared = false;
  double difference_rad = 0.0;  // median of the posterior minus theory
  double p_below = 0.0;         // P(boundary angle < theory)
  double p_within = 0.0;        // P(|boundary angle - theory| <= margin)
  // E_n = difference / sqrt(U^2 + U_theory^2), U half of the 95 % interval,
  // U_theory = 2 u; |E_n| <= 1 is called compatible.
  double e_n = 0.0;
  // Equivalence by two one-sided tests, read from the posterior: P(boundary
  // below theory - margin) and P(above theory + margin). Both under 0.05 is the
  // 90 % interval inside the margin.
  double p_too_low = 0.0;
  double p_too_high = 0.0;
  double smallest_margin_rad = 0.0;
  Agreement agreement;
  // What the verdict rests on, and the verdict; absent with the reason where
  // there is none to give.
  VerdictBasis basis;
  Judgement judgement;
  // Forecast: further trials until the verdict would no longer be inconclusive,
  // if the boundary is where it is believed to be now; nothing where it is not
  // inconclusive.
  std::optional<int> trials_to_decide;
  // The shot that would most likely decide, within the angles that can be
  // thrown; where there is a forecast.
  std::optional<DecidingShot> deciding;
  // Of the confusion matrix, without trials that decide nothing; absent where
  // none is left.
  std::optional<core::Interval> wilson95;
  std::optional<core::Interval> clopper_pearson95;
  std::optional<CohensKappa> kappa;  // absent where undefined
  std::optional<double> matthews;    // absent where undefined
};

struct BoundaryStudy {
  Counts counts;
  Bracket bracket;
  double least_u_rad = 0.0;  // of the angles, own and common part together
  double greatest_u_rad = 0.0;
  // Trials whose set angle enters the fits beside the measured one, the
  // ejector's repeatability that they show, and its deviation from one set
  // angle to another (set_angles.h).
  int used_set_angles = 0;
  std::optional<double> set_within_rad;
  std::optional<double> set_between_rad;
  BoundaryPosterior posterior;
  LikelihoodProfile likelihood;
  double margin_rad = 0.0;
  std::vector<TheoryComparison> theories;  // the declared one first
  NextAngle next;
};

// All observations must be of one group (observation.h). Throws like the
// functions it calls.
BoundaryStudy StudyBoundary(std::span<const Observation> observations,
                            const StudyOptions& options = {});

}  // namespace touchdown::analysis
