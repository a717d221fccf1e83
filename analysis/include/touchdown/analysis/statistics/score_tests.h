// Does the boundary depend on anything that the model leaves out? Score tests:
// drift over the sequence, speed, spin, surface, operator.
//
// Model: P_i = Phi((x_i - theta - delta c_i) / sigma_i), c_i a covariate that
// trial i bears, sigma_i^2 = s^2 + u_i^2. The test of delta = 0 needs no second
// fit: with z_i the argument of Phi at the estimate, residuals
//   e_i = (p_i - P_i) phi(z_i) / (sigma_i P_i (1 - P_i)),
// weights w_i = phi(z_i)^2 / (sigma_i^2 P_i (1 - P_i)), and c* what is left of
// c when its weighted regression on 1 and z (boundary and scatter, which were
// fitted) is taken off,
//   Z = -sum e_i c*_i / sqrt(sum w_i c*_i^2)
// is standard normal where nothing depends on c (Rao 1948); Z > 0: the boundary
// rises with c.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "touchdown/analysis/statistics/boundary_fit.h"
#include "touchdown/analysis/statistics/observation.h"

namespace touchdown::analysis {

struct ScoreTest {
  double z = 0.0;
  double p = 1.0;  // two-sided
  // The boundary's change for one unit of c that the score points to, one
  // Newton step from none; radians a unit, with its standard uncertainty.
  double slope_rad = 0.0;
  double u_slope_rad = 0.0;
  int trials = 0;  // that bear the covariate and tell something
};

// Fewer trials than this that bear the covariate are not tested: the normal
// approximation needs them.
inline constexpr int kFewestToTest = 10;

// `covariate[i]` is that of observations[i]; absent where unknown. Nothing
// where it does not vary, where fewer than kFewestToTest trials bear it, or
// where no trial is near enough to the boundary to tell. Throws
// std::invalid_argument where the two differ in number.
std::optional<ScoreTest> TestCovariate(
    std::span<const Observation> observations,
    std::span<const std::optional<double>> covariate,
    const BoundaryPosterior& posterior);

// The same for a covariate of names (surface, operator): each name against all
// others, and of these the one with the least p, times their number
// (Bonferroni). Empty names are unknown.
struct NamedScoreTest {
  ScoreTest test;
  std::string name;  // the one that stands out most
};
std::optional<NamedScoreTest> TestNames(
    std::span<const Observation> observations,
    std::span<const std::string> names, const BoundaryPosterior& posterior);

}  // namespace touchdown::analysis
