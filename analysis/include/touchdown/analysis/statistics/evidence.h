// How well the trials fit a boundary within a theory's margin, and outside it:
// what a verdict rests on, beside the posterior.
//
// pl(theta) = max over s of l(theta, s), l as in boundary_fit.h: every scatter
// is allowed, and no prior enters. Where trials share an error (a set-up's
// common u), it is integrated over its normal distribution, set-up by set-up,
// before the maximum is taken. The evidence is the greatest pl in each of five
// ranges of theta. Their differences are generalised log likelihood ratios.
#pragma once

#include <cstddef>
#include <map>
#include <numbers>
#include <span>
#include <vector>

#include "touchdown/analysis/statistics/agreement.h"
#include "touchdown/analysis/statistics/boundary_fit.h"
#include "touchdown/analysis/statistics/observation.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {

// U = 2 u: the coverage factor of a theory's expanded uncertainty.
inline constexpr double kTheoryCoverage = 2.0;

struct EvidenceOptions {
  // Angles at which the boundary can be.
  double low_rad = 0.0;
  double high_rad = std::numbers::pi / 2;
  // The scatters that are allowed, `scatter_levels` of them equally spaced in
  // ln s; between them the maximum is taken from a parabola. 30 levels leave
  // log ratios of 2 right to 0.05, 16 to 0.15 in half of the time
  // (evidence_test.cc).
  double scatter_low_rad = 0.05 * core::kDegree;
  double scatter_high_rad = 40.5 * core::kDegree;
  int scatter_levels = 30;
  // Steps of the angle grid within five margins of the theory; they widen by a
  // quarter from one to the next beyond. More is slower.
  int steps_per_margin = 10;
  double lapse = 0.0;  // as the posterior was made with
  // Trials beyond this number are binned, as in boundary_fit.h.
  std::size_t bin_above = 2000;
  double bin_width_rad = 0.05 * core::kDegree;
};

// Greatest log likelihoods, 0 for the greatest of all.
struct Evidence {
  double log_below = 0.0;   // theta <= value - margin
  double log_within = 0.0;  // |theta - value| <= margin
  double log_above = 0.0;   // theta >= value + margin
  // The same with margin + U of the theory in the place of the margin; only
  // what a contradiction needs.
  double log_far_below = 0.0;
  double log_near = 0.0;
  double log_far_above = 0.0;
};

// The table l(theta, s) of one theory and margin. Adding a trial costs one pass
// over it (30 us), so that each look of a campaign is cheap.
class EvidenceTable {
 public:
  // Throws std::invalid_argument naming the argument that is out of its range.
  EvidenceTable(const TheoryBoundary& theory, double margin_rad,
                const EvidenceOptions& options = {});

  void Add(std::span<const Observation> observations);
  // Takes out what was added, the very same.
  void Remove(std::span<const Observation> observations);

  Evidence Weigh() const;

  // The posterior of theta and s on the table's grid.
  BoundaryGrid Posterior(const ScatterPrior& prior = {}) const;

 private:
  // Trials of one set-up: their table and what they share.
  struct SetUp {
    std::vector<double> log_likelihood;  // [angle * levels + scatter]
    double common_squares_rad2 = 0.0;    // sum of common u^2
    double trials = 0.0;
  };

  void Count(std::span<const Observation> observations, double times);
  // The sum over the set-ups, common errors integrated.
  std::vector<double> Joint() const;
  // max over s of each row of a table, refined between the levels.
  std::vector<double> Profile(const std::vector<double>& joint) const;
  double Greatest(const std::vector<double>& profile, double low_rad,
                  double high_rad) const;

  EvidenceOptions options_;
  double margin_low_rad_;
  double margin_high_rad_;
  double far_low_rad_;
  double far_high_rad_;
  std::vector<double> angle_rad_;
  std::vector<double> scatter_rad_;
  std::map<int, SetUp> setups_;
};

// The evidence of all trials at once. Throws like EvidenceTable.
Evidence WeighEvidence(std::span<const Observation> observations,
                       const TheoryBoundary& theory, double margin_rad,
                       const EvidenceOptions& options = {});

}  // namespace touchdown::analysis
