// The part of each frame that a body passes, as numbers: what the layers are
// learned from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "touchdown/core/points.h"

namespace touchdown::vision::layers {

// Pictures of one size. Of each a window is held: the whole picture, or the
// surroundings of the body where nothing else changes.
struct PictureStack {
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::vector<std::int64_t> frames;      // their indices in the clip
  std::vector<double> times_s;           // middle of the exposure
  std::vector<core::PixelRect> windows;  // within the picture
  std::vector<std::size_t> begins;       // of each window in `levels`
  std::vector<float> levels;             // DN; windows, row by row
  // DN; what every picture shows where it holds no window, row by row. Empty
  // where all windows are whole pictures.
  std::vector<float> outside;

  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  // The window's part of a picture's row, which it has.
  const float* WindowRow(std::size_t picture, std::int32_t row) const {
    const core::PixelRect& window = windows[picture];
    return levels.data() + begins[picture] +
           static_cast<std::size_t>(row - window.y) *
               static_cast<std::size_t>(window.width);
  }
  // Adds a picture. Where its window's levels are to be written, until the next
  // is added.
  float* Add(std::int64_t frame, const core::PixelRect& window);
  // No pictures; the memory is kept.
  void Clear();
};

// Some of them.
PictureStack Choose(const PictureStack& all,
                    const std::vector<std::size_t>& chosen);

// All at half the resolution: means of two by two pixels. Pixel (i, j) of
// it has its centre at 2 i + 0.5, 2 j + 0.5. Windows begin and end at even
// pixels.
PictureStack Halve(const PictureStack& full, int threads);
std::vector<float> Halve(const std::vector<float>& picture, std::int32_t width,
                         std::int32_t height);

}  // namespace touchdown::vision::layers
