// Which pixels of a frame differ from the still picture: one pass over the
// frame without pictures in between, so that most frames, in which nearly
// nothing differs, cost little more than being read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "touchdown/core/frame.h"
#include "touchdown/vision/background/background.h"

namespace touchdown::vision {

// One byte a pixel of a window: 255 where it differs, else 0.
struct ChangedPixels {
  std::int32_t width_px = 0;
  std::vector<std::uint8_t> mask;  // row by row
  // Rows from the first to the last that has one; equal where none has.
  std::int32_t first_row = 0;
  std::int32_t last_row = 0;
};

// A pixel differs where the 3 x 3 mean of frame minus background is above
// `threshold_dn` in magnitude. `window`: in the frame's own pixels. Beyond its
// sides the difference is mirrored about the outermost pixels (OpenCV's
// BORDER_REFLECT_101). In place of what `changed` held.
void FindChangedPixels(const core::Frame& frame, const Background& background,
                       const core::PixelRect& window, float threshold_dn,
                       ChangedPixels& changed);

}  // namespace touchdown::vision
