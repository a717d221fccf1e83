// The mean of the middle half of many pictures, pixel by pixel: a sorting
// network on blocks of pixels, whose exchanges are plain loops of minimum and
// maximum that the compiler vectorises.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "touchdown/core/frame.h"

namespace touchdown::vision {

// Of `count` values the middle ones are [MidBegin, count - MidBegin): half of
// them; all of one or two.
constexpr std::size_t MidBegin(std::size_t count) {
  return count <= 2 ? 0 : count / 4;
}

// Pixels that are sorted at once: 33 samples of 16 bits take 4 KiB.
inline constexpr std::size_t kLanes = 64;

// Row `y` of a window from its column `x` on, up to kLanes of it.
template <class Sample>
void LoadLanes(const core::Frame& frame, std::int32_t x, std::int32_t y,
               Sample* lanes) {
  const auto count = std::min<std::size_t>(
      kLanes, static_cast<std::size_t>(frame.width_px - x));
  std::memcpy(lanes, frame.row<Sample>(y) + x, count * sizeof(Sample));
}

// lanes[k * kLanes + i]: sample k of pixel i. Sorts each pixel's samples.
class SortingNetwork {
 public:
  // All `count` places in order, or (kMiddle) only so far that the middle
  // ones are in the middle, in any order.
  enum class Order { kFull, kMiddle };
  SortingNetwork(std::size_t count, Order order);

  void Sort(std::uint8_t* lanes) const;
  void Sort(std::uint16_t* lanes) const;
  void Sort(float* lanes) const;

 private:
  std::vector<std::pair<std::size_t, std::size_t>> exchanges_;
};

// Adds up the samples [begin, end) of each pixel, in the order of `lanes`.
void AddSamples(const std::uint8_t* lanes, std::size_t begin, std::size_t end,
                std::uint32_t* sums);
void AddSamples(const std::uint16_t* lanes, std::size_t begin, std::size_t end,
                std::uint32_t* sums);

}  // namespace touchdown::vision
