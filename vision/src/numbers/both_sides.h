// Some of many in a row, the same ones whichever end comes first: pixels in a
// mirror, frames of a clip that is played backwards.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace touchdown::vision {

// Of 0 .. count - 1 every `step`-th from both ends to the middle, in order.
inline std::vector<std::size_t> FromBothSides(std::size_t count,
                                              std::size_t step) {
  std::vector<std::size_t> some;
  if (count == 0) return some;
  some.reserve(count / step + 2);
  for (std::size_t i = 0; 2 * i < count; i += step) {
    some.push_back(i);
    if (2 * i + 1 != count) some.push_back(count - 1 - i);
  }
  std::sort(some.begin(), some.end());
  return some;
}

}  // namespace touchdown::vision
