#include "background/mid_mean.h"

#include <algorithm>
#include <bit>

#include "numbers/lanes.h"

namespace touchdown::vision {
namespace {

using Exchanges = std::vector<std::pair<std::size_t, std::size_t>>;

// Apart from each other in memory, which the compiler is told.
template <class Sample>
TOUCHDOWN_INLINE void Exchange(Sample* __restrict a, Sample* __restrict b) {
  for (std::size_t k = 0; k < kLanes; ++k) {
    const Sample one = a[k];
    const Sample other = b[k];
    a[k] = one < other ? one : other;
    b[k] = one < other ? other : one;
  }
}

template <class Sample>
TOUCHDOWN_INLINE void ExchangeAll(const Exchanges& exchanges, Sample* lanes) {
  for (const auto& [i, j] : exchanges) {
    Exchange(lanes + i * kLanes, lanes + j * kLanes);
  }
}

template <class Sample>
TOUCHDOWN_INLINE void AddAll(const Sample* lanes, std::size_t begin,
                             std::size_t end, std::uint32_t* __restrict sums) {
  std::fill_n(sums, kLanes, 0U);
  for (std::size_t k = begin; k < end; ++k) {
    const Sample* const row = lanes + k * kLanes;
    for (std::size_t i = 0; i < kLanes; ++i) sums[i] += row[i];
  }
}

}  // namespace

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

TOUCHDOWN_WIDEST void SortingNetwork::Sort(std::uint8_t* lanes) const {
  ExchangeAll(exchanges_, lanes);
}

TOUCHDOWN_WIDEST void SortingNetwork::Sort(std::uint16_t* lanes) const {
  ExchangeAll(exchanges_, lanes);
}

TOUCHDOWN_WIDEST void SortingNetwork::Sort(float* lanes) const {
  ExchangeAll(exchanges_, lanes);
}

TOUCHDOWN_WIDEST void AddSamples(const std::uint8_t* lanes, std::size_t begin,
                                 std::size_t end, std::uint32_t* sums) {
  AddAll(lanes, begin, end, sums);
}

TOUCHDOWN_WIDEST void AddSamples(const std::uint16_t* lanes, std::size_t begin,
                                 std::size_t end, std::uint32_t* sums) {
  AddAll(lanes, begin, end, sums);
}

}  // namespace touchdown::vision
