// Points and rectangles. Two strong types where swapping would be silent.
#pragma once

#include <cstdint>

namespace touchdown::core {

// In the image: x right, y down, pixel centres at integers. Always in the
// coordinates of the whole recorded picture, never of a crop of it.
struct PixelPoint {
  double x_px = 0.0;
  double y_px = 0.0;

  friend bool operator==(const PixelPoint&, const PixelPoint&) = default;
};

// In the plane frame: x along the ground line in the direction of travel, y
// along its normal, upward; ground is y = 0. Metres.
struct PlanePoint {
  double x_m = 0.0;
  double y_m = 0.0;

  friend bool operator==(const PlanePoint&, const PlanePoint&) = default;
};

// Whole pixels [x, x + width) x [y, y + height) of the recorded picture.
struct PixelRect {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t width = 0;
  std::int32_t height = 0;

  friend bool operator==(const PixelRect&, const PixelRect&) = default;
};

}  // namespace touchdown::core
