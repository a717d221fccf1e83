#include "layers/picture_stack.h"

#include <algorithm>

#include "touchdown/core/parallel.h"

namespace touchdown::vision::layers {
namespace {

void HalvePicture(const float* from, std::int32_t width, std::int32_t height,
                  float* to) {
  for (std::int32_t y = 0; y + 1 < height; y += 2) {
    const float* const upper = from + static_cast<std::ptrdiff_t>(y) * width;
    const float* const lower = upper + width;
    for (std::int32_t x = 0; x + 1 < width; x += 2) {
      *to++ = 0.25F * (upper[x] + upper[x + 1] + lower[x] + lower[x + 1]);
    }
  }
}

std::size_t CountPixels(const core::PixelRect& window) {
  return static_cast<std::size_t>(window.width) *
         static_cast<std::size_t>(window.height);
}

}  // namespace

float* PictureStack::Add(std::int64_t frame, const core::PixelRect& window) {
  frames.push_back(frame);
  times_s.push_back(0.0);
  windows.push_back(window);
  begins.push_back(levels.size());
  levels.resize(levels.size() + CountPixels(window));
  return levels.data() + begins.back();
}

void PictureStack::Clear() {
  frames.clear();
  times_s.clear();
  windows.clear();
  begins.clear();
  levels.clear();
}

PictureStack Choose(const PictureStack& all,
                    const std::vector<std::size_t>& chosen) {
  PictureStack some;
  some.width = all.width;
  some.height = all.height;
  some.outside = all.outside;
  for (const std::size_t i : chosen) {
    const auto from =
        all.levels.begin() + static_cast<std::ptrdiff_t>(all.begins[i]);
    float* const to = some.Add(all.frames[i], all.windows[i]);
    some.times_s.back() = all.times_s[i];
    std::copy_n(from, CountPixels(all.windows[i]), to);
  }
  return some;
}

PictureStack Halve(const PictureStack& full, int threads) {
  PictureStack half;
  half.width = full.width / 2;
  half.height = full.height / 2;
  if (!full.outside.empty()) {
    half.outside = Halve(full.outside, full.width, full.height);
  }
  for (std::size_t t = 0; t < full.frames.size(); ++t) {
    const core::PixelRect& window = full.windows[t];
    half.Add(full.frames[t],
             {window.x / 2, window.y / 2, window.width / 2, window.height / 2});
    half.times_s.back() = full.times_s[t];
  }
  core::InParallel(static_cast<std::int64_t>(half.frames.size()), threads,
                   [&](std::int64_t begin, std::int64_t end) {
                     for (auto t = static_cast<std::size_t>(begin);
                          t < static_cast<std::size_t>(end); ++t) {
                       const core::PixelRect& window = full.windows[t];
                       HalvePicture(full.WindowRow(t, window.y), window.width,
                                    window.height,
                                    half.levels.data() + half.begins[t]);
                     }
                   });
  return half;
}

std::vector<float> Halve(const std::vector<float>& picture, std::int32_t width,
                         std::int32_t height) {
  std::vector<float> half(static_cast<std::size_t>(width / 2) *
                          static_cast<std::size_t>(height / 2));
  HalvePicture(picture.data(), width, height, half.data());
  return half;
}

}  // namespace touchdown::vision::layers
