// The probit regression that published designs (classic_designs.h) place their
// levels by: P(bounce) = Phi((x - mean) / scatter), both by greatest
// likelihood. Angles count as exact, and there is no prior: a posterior's
// (boundary_fit.h) is the estimate. STATISTICS.md says why.
#pragma once

#include <optional>
#include <span>

#include "touchdown/analysis/statistics/observation.h"

namespace touchdown::analysis {

struct ProbitFit {
  double mean = 0.0;  // where P = 1/2
  double scatter = 0.0;
};

// Of decided trials. Nothing where the likelihood has no maximum (outcomes that
// do not overlap, or fewer than two angles), or where bounces do not grow more
// likely with the angle.
std::optional<ProbitFit> FitProbit(std::span<const Observation> trials);

}  // namespace touchdown::analysis
