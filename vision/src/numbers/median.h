// The middle of many numbers, and where it lies from a sample of them: what is
// not near need not be put in order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace touchdown::vision {

// Of an even number the mean of the two in the middle: that of values which
// change sign in a mirror does so, too.
double Median(std::vector<double> values);
// Fewer than this are as well put in order themselves.
inline constexpr std::size_t kManyNumbers = 1000;

// Two of `count` numbers between which their median is nearly always. at(i) is
// the i-th of them.
template <class At>
std::pair<double, double> BracketOfMedian(std::size_t count, const At& at) {
  constexpr std::size_t kSample = 128;
  constexpr std::size_t kSpare = 20;  // places: 3.5 standard deviations
  std::vector<double> some;
  some.reserve(kSample);
  for (std::size_t k = 0; k < kSample; ++k) {
    some.push_back(at(k * count / kSample));
  }
  std::sort(some.begin(), some.end());
  return {some[kSample / 2 - kSpare], some[kSample / 2 + kSpare]};
}

}  // namespace touchdown::vision
