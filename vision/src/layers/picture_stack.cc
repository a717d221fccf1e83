#include "layers/picture_stack.h"

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

}  // namespace

PictureStack Choose(const PictureStack& all,
                    const std::vector<std::size_t>& chosen) {
  PictureStack some;
  some.width = all.width;
  some.height = all.height;
  for (const std::size_t i : chosen) {
    some.frames.push_back(all.frames[i]);
    some.times_s.push_back(all.times_s[i]);
    some.levels.insert(some.levels.end(), all.of(i), all.of(i) + all.pixels());
  }
  return some;
}

PictureStack Halve(const PictureStack& full, int threads) {
  PictureStack half;
  half.width = full.width / 2;
  half.height = full.height / 2;
  half.frames = full.frames;
  half.times_s = full.times_s;
  half.levels.resize(half.pixels() * half.frames.size());
  core::InParallel(static_cast<std::int64_t>(half.frames.size()), threads,
                   [&](std::int64_t begin, std::int64_t end) {
                     for (auto t = static_cast<std::size_t>(begin);
                          t < static_cast<std::size_t>(end); ++t) {
                       HalvePicture(full.of(t), full.width, full.height,
                                    half.levels.data() + t * half.pixels());
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
