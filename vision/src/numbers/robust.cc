#include "numbers/robust.h"

#include <algorithm>
#include <utility>

namespace touchdown::vision {
namespace {

// Keeps, of many numbers, those near their median, in a loop without branches.
// Returns how many of those left out are less.
std::size_t KeepNearMedian(std::vector<double>& values) {
  const auto [low, high] =
      BracketOfMedian(values.size(), [&](std::size_t i) { return values[i]; });
  std::vector<double> near(values.size());
  std::size_t below = 0;
  std::size_t kept = 0;
  for (const double value : values) {
    near[kept] = value;
    below += static_cast<std::size_t>(value < low);
    kept += static_cast<std::size_t>(value >= low) &
            static_cast<std::size_t>(value <= high);
  }
  const std::size_t middle = values.size() / 2;
  if (middle <= below || middle >= below + kept) return 0;
  near.resize(kept);
  values = std::move(near);
  return below;
}

}  // namespace

double Median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const bool odd = values.size() % 2 == 1;
  std::size_t place = values.size() / 2;
  if (values.size() >= kManyNumbers) place -= KeepNearMedian(values);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(place);
  std::nth_element(values.begin(), middle, values.end());
  // The lower of the two middle numbers is the largest of those before the
  // upper one.
  if (odd) return *middle;
  return 0.5 * (*std::max_element(values.begin(), middle) + *middle);
}

}  // namespace touchdown::vision
