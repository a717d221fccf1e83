#include "touchdown/analysis/statistics/control_chart.h"

#include <cmath>

#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

// The mean range of two values of a normal distribution, in its standard
// deviations: 2 / sqrt(pi) = 1.1284, rounded as the tables have it.
constexpr double kD2 = 1.128;
constexpr double kLimit_sigma = 3.0;

}  // namespace

core::Expected<IndividualsChart> ChartIndividuals(
    std::span<const double> values) {
  for (const double value : values) {
    core::RequireFinite("values", value);
  }
  if (values.size() < 2) {
    return core::AbsentBecause("a control chart needs two values");
  }
  IndividualsChart out;
  double sum = values[0];
  double ranges = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    sum += values[i];
    ranges += std::abs(values[i] - values[i - 1]);
  }
  out.centre = sum / static_cast<double>(values.size());
  out.mean_range = ranges / static_cast<double>(values.size() - 1);
  out.sigma = out.mean_range / kD2;
  out.lower = out.centre - kLimit_sigma * out.sigma;
  out.upper = out.centre + kLimit_sigma * out.sigma;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] < out.lower || values[i] > out.upper) out.beyond.push_back(i);
  }
  out.provisional = values.size() < kEnoughForLimits;
  return out;
}

}  // namespace touchdown::analysis
