#include "statistics/design.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace touchdown::analysis {

Design Reweigh(const BoundaryPosterior& posterior, const ScatterPrior& prior) {
  Design out{posterior.grid, 0.0, 0.0};
  const std::size_t m = out.grid.scatter_rad.size();
  std::vector<double> log_ratio;
  for (const double s : out.grid.scatter_rad) {
    log_ratio.push_back(LogDensity(prior, s) - LogDensity(posterior.prior, s));
  }
  const double most = *std::max_element(log_ratio.begin(), log_ratio.end());
  double total = 0.0;
  for (std::size_t k = 0; k < out.grid.weight.size(); ++k) {
    total += out.grid.weight[k] *= std::exp(log_ratio[k % m] - most);
  }
  for (std::size_t k = 0; k < out.grid.weight.size(); ++k) {
    out.grid.weight[k] /= total;
    out.mean_rad += out.grid.weight[k] * out.grid.angle_rad[k / m];
  }
  double variance = 0.0;
  for (std::size_t k = 0; k < out.grid.weight.size(); ++k) {
    const double d = out.grid.angle_rad[k / m] - out.mean_rad;
    variance += out.grid.weight[k] * d * d;
  }
  out.sd_rad = std::sqrt(variance);
  return out;
}

}  // namespace touchdown::analysis
