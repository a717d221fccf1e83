// How the uncertainty of a boundary model's inputs reaches its angle. Internal
// to analysis.
#pragma once

#include <random>

#include "touchdown/analysis/theory/boundary_models.h"

namespace touchdown::analysis {

inline bool IsSphere(const BoundaryInputs& in) {
  return in.body == core::BodyKind::kSphere;
}

// The printed equations' boundary of spin, theta = asin(g / (R omega^2)), or
// why there is none (boundary_models.cc).
core::Expected<double> SpinAngle(const BoundaryInputs& in);

// True where an input that the model uses has a standard uncertainty. Throws
// std::invalid_argument where one is negative.
bool HasUncertainty(BoundaryModel model, const BoundaryInputs& in);

// Fills `out` to first order, with the sensitivities; out.boundary_rad is
// there.
void PropagateFirstOrder(BoundaryModel model, const BoundaryInputs& in,
                         BoundaryAnswer& out);

// Fills `out` by `n_draws` draws of the inputs.
void PropagateByDraws(BoundaryModel model, const BoundaryInputs& in,
                      std::mt19937_64& engine, int n_draws,
                      BoundaryUncertainty& out);

}  // namespace touchdown::analysis
