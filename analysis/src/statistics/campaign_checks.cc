#include "touchdown/analysis/statistics/campaign_checks.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "touchdown/core/require.h"

namespace touchdown::analysis {

core::Expected<PooledCheck> PoolChecks(std::span<const core::Estimate> ratios,
                                       double common_u,
                                       const PoolOptions& options) {
  constexpr double kOneSided95 = 1.6449;  // Phi^-1(0.95)
  core::RequireNotNegative("common u", common_u);
  const auto n = static_cast<int>(ratios.size());
  if (n < options.least_trials) {
    return core::AbsentBecause(
        n == 0 ? std::string("no trial tells it")
               : fmt::format("{} trial{} tell{} it, {} are needed", n,
                             n == 1 ? "" : "s", n == 1 ? "s" : "",
                             options.least_trials));
  }
  double weights = 0.0;
  double sum = 0.0;
  for (const core::Estimate& r : ratios) {
    core::RequirePositive("u of a ratio", r.u);
    weights += 1.0 / (r.u * r.u);
    sum += r.value / (r.u * r.u);
  }
  PooledCheck out;
  out.trials = n;
  out.ratio.value = sum / weights;
  double chi2 = 0.0;
  for (const core::Estimate& r : ratios) {
    const double off = (r.value - out.ratio.value) / r.u;
    chi2 += off * off;
  }
  const double birge = std::max(1.0, chi2 / (n - 1));
  out.ratio.u = std::sqrt(birge / weights + common_u * common_u);
  out.z = (out.ratio.value - 1.0) / out.ratio.u;
  out.failed = std::abs(out.z) > options.most_z;
  // Another campaign's scatter may widen its u: by one standard deviation of
  // sqrt(chi^2 / (n - 1)).
  const double wider = 1.0 + 1.0 / std::sqrt(2.0 * (n - 1));
  out.shows = (options.most_z + kOneSided95) *
              std::hypot(wider * std::sqrt(birge / weights), common_u);
  return out;
}

}  // namespace touchdown::analysis
