// A control chart of single values: is a process as steady as its variation
// from one value to the next says? (NIST/SEMATECH e-Handbook of Statistical
// Methods, 6.3.2.2 "Individuals control charts"; Montgomery, Introduction to
// Statistical Quality Control, section 6.4.)
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "touchdown/core/expected.h"

namespace touchdown::analysis {

// Limits from fewer values are provisional: the books ask for 20 to 25.
inline constexpr std::size_t kEnoughForLimits = 20;

struct IndividualsChart {
  double centre = 0.0;      // mean of the values
  double mean_range = 0.0;  // mean of |x_i - x_(i-1)|
  double sigma = 0.0;       // mean_range / d2, d2 = 1.128 for two values
  double lower = 0.0;       // centre - 3 sigma
  double upper = 0.0;       // centre + 3 sigma
  std::vector<std::size_t> beyond;  // indices of the values outside the limits
  bool provisional = true;          // fewer than kEnoughForLimits values
};

// `values` in the order in which they were taken. Absent for fewer than two,
// which have no range. Throws std::invalid_argument where a value is not
// finite.
core::Expected<IndividualsChart> ChartIndividuals(
    std::span<const double> values);

}  // namespace touchdown::analysis
