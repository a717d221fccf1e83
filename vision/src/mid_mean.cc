#include "mid_mean.h"

#include <bit>

namespace touchdown::vision {

// Batcher's merge exchange (Knuth, The Art of Computer Programming, vol. 3,
// algorithm 5.2.2M), for any number of samples.
SortingNetwork::SortingNetwork(std::size_t count, Order order) {
  if (count < 2) return;
  const std::size_t top = std::bit_ceil(count) / 2;
  for (std::size_t p = top; p > 0; p /= 2) {
    std::size_t q = top;
    std::size_t r = 0;
    std::size_t d = p;
    for (;;) {
      for (std::size_t i = 0; i + d < count; ++i) {
        if ((i & p) == r) exchanges_.emplace_back(i, i + d);
      }
      if (q == p) break;
      d = q - p;
      q /= 2;
      r = p;
    }
  }
  if (order == Order::kFull) return;
  // Backwards: an exchange of two places that end in the same part (below, in
  // or above the middle), and that nothing later tells apart, is not needed.
  const std::size_t begin = MidBegin(count);
  std::vector<std::size_t> part(count);
  for (std::size_t i = 0; i < count; ++i) {
    part[i] = i < begin ? 0 : i < count - begin ? 1 : 2;
  }
  std::size_t next = 3;
  std::vector<std::pair<std::size_t, std::size_t>> needed;
  for (std::size_t k = exchanges_.size(); k-- > 0;) {
    const auto [i, j] = exchanges_[k];
    if (part[i] == part[j]) continue;
    part[i] = next++;
    part[j] = next++;
    needed.push_back(exchanges_[k]);
  }
  exchanges_.assign(needed.rbegin(), needed.rend());
}

}  // namespace touchdown::vision
