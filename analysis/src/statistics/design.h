// The posterior that trials are planned with. Internal to analysis.
#pragma once

#include "touchdown/analysis/statistics/boundary_fit.h"

namespace touchdown::analysis {

// The posterior as it would be under another prior on the scatter, with its
// moments.
struct Design {
  BoundaryGrid grid;
  double mean_rad = 0.0;
  double sd_rad = 0.0;
};

Design Reweigh(const BoundaryPosterior& posterior, const ScatterPrior& prior);

}  // namespace touchdown::analysis
