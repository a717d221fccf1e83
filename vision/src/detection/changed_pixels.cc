#include "detection/changed_pixels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "numbers/lanes.h"

namespace touchdown::vision {
namespace {

// The frame's row minus that of the background, into place 1 of `difference`,
// and each with its two neighbours, `sum`.
template <class Sample>
TOUCHDOWN_INLINE void SumNeighbours(const Sample* __restrict row,
                                    const float* __restrict still,
                                    std::size_t count,
                                    float* __restrict difference,
                                    float* __restrict sum) {
  for (std::size_t x = 0; x < count; ++x) {
    difference[x + 1] = static_cast<float>(row[x]) - still[x];
  }
  difference[0] = difference[std::min<std::size_t>(2, count)];
  difference[count + 1] = difference[count > 1 ? count - 1 : 1];
  for (std::size_t x = 0; x < count; ++x) {
    sum[x] = difference[x] + difference[x + 1] + difference[x + 2];
  }
}

TOUCHDOWN_WIDEST
void SumOfRow(const std::uint8_t* row, const float* still, std::size_t count,
              float* difference, float* sum) {
  SumNeighbours(row, still, count, difference, sum);
}

TOUCHDOWN_WIDEST
void SumOfRow(const std::uint16_t* row, const float* still, std::size_t count,
              float* difference, float* sum) {
  SumNeighbours(row, still, count, difference, sum);
}

// Where three rows' sums together exceed `most`; whether any does.
TOUCHDOWN_WIDEST
bool MarkRow(const float* __restrict above, const float* __restrict at,
             const float* __restrict below, std::size_t count, float most,
             std::uint8_t* __restrict mask) {
  std::uint8_t any = 0;
  for (std::size_t x = 0; x < count; ++x) {
    const float sum = std::abs(above[x] + at[x] + below[x]);
    mask[x] = sum > most ? 255 : 0;
    any |= mask[x];
  }
  return any != 0;
}

template <class Sample>
void MarkChanged(const core::Frame& frame, const Background& background,
                 const core::PixelRect& window, float threshold_dn,
                 ChangedPixels& changed) {
  const auto count = static_cast<std::size_t>(window.width);
  std::vector<float> difference(count + 2);
  std::array<std::vector<float>, 3> sums;  // of the rows y modulo 3
  for (std::vector<float>& sum : sums) sum.resize(count);
  const auto sum_of = [&](std::int32_t y) -> std::vector<float>& {
    return sums[static_cast<std::size_t>(y % 3)];
  };
  const auto look = [&](std::int32_t y) {
    const std::ptrdiff_t still_y = frame.origin_y_px + window.y + y;
    SumOfRow(frame.row<Sample>(window.y + y) + window.x,
             background.level.data() + still_y * background.width_px +
                 frame.origin_x_px + window.x,
             count, difference.data(), sum_of(y).data());
  };
  const float most = 9.0F * threshold_dn;  // of nine pixels
  const std::int32_t last = window.height - 1;
  look(0);
  for (std::int32_t y = 0; y <= last; ++y) {
    if (y < last) look(y + 1);
    const std::int32_t above = y > 0 ? y - 1 : std::min(1, last);
    const std::int32_t below = y < last ? y + 1 : std::max(last - 1, 0);
    if (MarkRow(sum_of(above).data(), sum_of(y).data(), sum_of(below).data(),
                count, most,
                changed.mask.data() + static_cast<std::size_t>(y) * count)) {
      if (changed.last_row == changed.first_row) changed.first_row = y;
      changed.last_row = y + 1;
    }
  }
}

}  // namespace

void FindChangedPixels(const core::Frame& frame, const Background& background,
                       const core::PixelRect& window, float threshold_dn,
                       ChangedPixels& changed) {
  changed.width_px = window.width;
  changed.first_row = changed.last_row = 0;
  changed.mask.resize(static_cast<std::size_t>(window.width) *
                      static_cast<std::size_t>(window.height));
  if (frame.is_16_bit()) {
    MarkChanged<std::uint16_t>(frame, background, window, threshold_dn,
                               changed);
  } else {
    MarkChanged<std::uint8_t>(frame, background, window, threshold_dn, changed);
  }
}

}  // namespace touchdown::vision
