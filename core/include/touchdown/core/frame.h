// A plain view of pixels: what readers hand out and measurers take.
#pragma once

#include <cstddef>
#include <cstdint>

#include "touchdown/core/points.h"

namespace touchdown::core {

// A view of one gray picture or of a window of it. It owns nothing: the reader
// that made it says how long the pixels live. Samples are unsigned, 8 bits each
// where bit_depth <= 8, else 16 bits in host byte order, right-aligned: full
// scale is (1 << bit_depth) - 1.
struct Frame {
  const std::byte* data = nullptr;  // sample (0, 0) of the view
  std::ptrdiff_t stride_bytes = 0;  // from one row to the next
  std::int32_t width_px = 0;        // of the view
  std::int32_t height_px = 0;
  std::int32_t bit_depth = 8;  // significant bits a sample, 1..16

  // Where sample (0, 0) of the view lies in the recorded picture: a crop
  // travels with the frame, so that calibration stays valid.
  std::int32_t origin_x_px = 0;
  std::int32_t origin_y_px = 0;

  std::int64_t index = 0;  // counts from 0 in the file
  double time_s = 0.0;     // middle of the exposure; frame 0 is time zero

  bool is_16_bit() const { return bit_depth > 8; }
  std::uint32_t full_scale() const { return (1u << bit_depth) - 1u; }

  template <class Sample>
  const Sample* row(std::int32_t y) const {
    return reinterpret_cast<const Sample*>(data + y * stride_bytes);
  }

  // Sample at (x, y) of the view; for tests and rare look-ups, not for loops.
  std::uint32_t at(std::int32_t x, std::int32_t y) const {
    return is_16_bit() ? row<std::uint16_t>(y)[x] : row<std::uint8_t>(y)[x];
  }
};

}  // namespace touchdown::core
