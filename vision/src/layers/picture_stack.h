// The part of each frame that a body passes, as numbers: what the layers are
// learned from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace touchdown::vision::layers {

// Pictures of one size, row by row, DN.
struct PictureStack {
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::vector<std::int64_t> frames;  // their indices in the clip
  std::vector<double> times_s;       // middle of the exposure
  std::vector<float> levels;         // of all pictures, one after the other

  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  const float* of(std::size_t picture) const {
    return levels.data() + picture * pixels();
  }
};

// Some of them.
PictureStack Choose(const PictureStack& all,
                    const std::vector<std::size_t>& chosen);

// All at half the resolution: means of two by two pixels. Pixel (i, j) of
// it has its centre at 2 i + 0.5, 2 j + 0.5.
PictureStack Halve(const PictureStack& full, int threads);
std::vector<float> Halve(const std::vector<float>& picture, std::int32_t width,
                         std::int32_t height);

}  // namespace touchdown::vision::layers
