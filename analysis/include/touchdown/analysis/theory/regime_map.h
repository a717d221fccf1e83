// The regime of a sliding contact over a grid of angle and spin or friction,
// and the lines of its complementarity problem: what the plots of theory are
// made of.
#pragma once

#include <vector>

#include "touchdown/analysis/theory/contact.h"

namespace touchdown::analysis {

enum class MapAxis { kOmega, kMu };

struct RegimeMapOptions {
  MapAxis axis = MapAxis::kMu;  // the second axis; the first is alpha
  double alpha_max_rad = 1.5707963267948966;  // from 0
  double axis_max = 6.0;                      // from 0; rad/s or dimensionless
  int alpha_points = 361;                     // both ends included, >= 2
  int axis_points = 241;
  // Everything else; alpha and the axis' own field are ignored.
  ContactProblem problem;
};

// Cell (i, j) belongs to alpha_rad[i] and axis[j] and lies at j * n_alpha + i.
struct RegimeMap {
  MapAxis axis = MapAxis::kMu;
  ContactProblem problem;  // what it was computed for
  std::vector<double> alpha_rad;
  std::vector<double> axis_value;
  std::vector<QuickContact> cells;

  const QuickContact& At(std::size_t i, std::size_t j) const {
    return cells[j * alpha_rad.size() + i];
  }
};

// About 7 ns a cell. Throws std::invalid_argument for an impossible argument.
RegimeMap ComputeRegimeMap(const RegimeMapOptions& options);

// The problem at one angle as a line y/g = A_hat f + b/g over f = F_n/(m g): it
// has a solution where the line meets the axes y = 0, f >= 0 or f = 0, y >= 0.
struct ComplementarityLine {
  double alpha_rad = 0.0;
  double slope = 0.0;      // A_hat
  double intercept = 0.0;  // b/g
  Regime regime = Regime::kSlide;
};
std::vector<ComplementarityLine> ComplementarityLines(
    const ContactProblem& problem, const std::vector<double>& alphas_rad);

}  // namespace touchdown::analysis
