// The part of each frame that a body passes, as numbers: what the layers are
// learned from.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
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
  // The level at any place of the picture, between four pixels of its window.
  // Absent where they are not all in it.
  std::optional<float> LevelAt(std::size_t picture, double x, double y) const {
    const core::PixelRect& window = windows[picture];
    const auto column = static_cast<std::int32_t>(std::floor(x));
    const auto row = static_cast<std::int32_t>(std::floor(y));
    if (column < window.x || row < window.y ||
        column + 1 >= window.x + window.width ||
        row + 1 >= window.y + window.height) {
      return std::nullopt;
    }
    const float* const above = WindowRow(picture, row) + (column - window.x);
    const float* const below = above + window.width;
    const auto right = static_cast<float>(x - column);
    const auto down = static_cast<float>(y - row);
    return (1.0F - down) * (above[0] + right * (above[1] - above[0])) +
           down * (below[0] + right * (below[1] - below[0]));
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
