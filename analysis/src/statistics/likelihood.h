// The log likelihood of (theta, s), shared by the posterior and the profile.
// Internal to analysis.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "statistics/hermite_table.h"
#include "touchdown/analysis/statistics/observation.h"

namespace touchdown::analysis {

// Trials that may be counted together: same angle, same u, same p.
struct Cell {
  double angle_rad = 0.0;
  double variance_rad2 = 0.0;  // u^2, and the spread inside a bin
  double p_bounce = 0.5;
  double count = 1.0;
};

// Cells of like trials. A width above 0 also puts neighbouring angles together:
// a cell has the mean angle of its members and their variance on top of u^2, so
// that the error of binning is of fourth order in the width. Trials that say
// nothing (p = 0.5) are dropped: they add a constant.
std::vector<Cell> MakeCells(std::span<const Observation> observations,
                            double bin_width_rad);

// log likelihood at one boundary angle and scatter, to the last digits.
double LogLikelihood(std::span<const Cell> cells, double angle_rad,
                     double scatter_rad, double lapse);

// Phi from a table, to 2e-10.
double FastNormalCdf(double z);

// The same for a fixed set of scatters, made for speed: log Phi comes from a
// table with an error below 2e-10 a trial.
class GridLikelihood {
 public:
  // `cells` must outlive the object.
  GridLikelihood(std::span<const Cell> cells,
                 std::span<const double> scatter_rad, double lapse);

  // out[j] = log likelihood at theta = angle and scatter_rad[j].
  void At(double angle_rad, std::span<double> out) const;

 private:
  std::span<const Cell> cells_;
  double lapse_;
  std::size_t levels_;
  // 1 / sqrt(s^2 + variance) for each distinct variance and each scatter.
  std::vector<double> inverse_;
  std::vector<std::size_t> row_;          // of a cell in `inverse_`
  std::vector<HermiteTable> with_lapse_;  // one where lapse > 0
};

}  // namespace touchdown::analysis
