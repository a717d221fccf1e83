// What robust estimates share.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace touchdown::vision {

// Standard deviation of normal values over the median of their sizes.
inline constexpr double kSigmaPerMedian = 1.4826;
// Standard deviations at which Tukey's weights end: 95 % efficient.
inline constexpr double kTukeyCut = 4.685;

// Of at least one value, which lose their order; of an even number the greater
// of the two in the middle.
inline float MedianInPlace(std::vector<float>& values) {
  const auto middle =
      values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace touchdown::vision
