// Robust estimates: medians, and what their weights share.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace touchdown::vision {

// Standard deviation of normal values over the median of their sizes.
inline constexpr double kSigmaPerMedian = 1.4826;
// Standard deviations at which Tukey's weights end: 95 % efficient.
inline constexpr double kTukeyCut = 4.685;

// Of an even number the mean of the two in the middle: that of values which
// change sign in a mirror does so, too.
double Median(std::vector<double> values);
// Fewer than this are as well put in order themselves.
inline constexpr std::size_t kManyNumbers = 1000;

// Two of `count` numbers between which their median is nearly always. at(i) is
// the i-th of them.
template <class At>
std::pair<double, double> BracketOfMedian(std::size_t count, const At& at) {
  // Numbers sampled for the bracket, and places to either side of their
  // median: 3.5 standard deviations, so that the bracket misses one time in
  // 2000.
  constexpr std::size_t kSample = 128;
  constexpr std::size_t kSpare = 20;
  std::vector<double> some;
  some.reserve(kSample);
  for (std::size_t k = 0; k < kSample; ++k) {
    some.push_back(at(k * count / kSample));
  }
  std::sort(some.begin(), some.end());
  return {some[kSample / 2 - kSpare], some[kSample / 2 + kSpare]};
}

// Of at least one value, which lose their order; of an even number the greater
// of the two in the middle.
inline float MedianInPlace(std::vector<float>& values) {
  const auto middle =
      values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace touchdown::vision
