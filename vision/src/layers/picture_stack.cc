#include "picture_stack.h"

#include "touchdown/core/parallel.h"

namespace touchdown::vision::layers {
namespace {

template <class Sample>
void Copy(const core::Frame& frame, const core::PixelRect& box, float* out) {
  for (std::int32_t y = 0; y < box.height; ++y) {
    const Sample* const row = frame.row<Sample>(box.y + y) + box.x;
    for (std::int32_t x = 0; x < box.width; ++x) {
      *out++ = static_cast<float>(row[x]);
    }
  }
}

void HalveInto(const float* from, std::int32_t width, std::int32_t height,
               float* to) {
  for (std::int32_t y = 0; y + 1 < height; y += 2) {
    const float* const upper = from + static_cast<std::ptrdiff_t>(y) * width;
    const float* const lower = upper + width;
    for (std::int32_t x = 0; x + 1 < width; x += 2) {
      *to++ =
          0.25F * (upper[x] + upper[x + 1] + lower[x] + lower[x + 1]);
    }
  }
}

}  // namespace

PictureStack ReadPictures(Clip& clip, std::span<const std::int64_t> frames,
                          const core::PixelRect& box) {
  PictureStack stack;
  stack.width = box.width;
  stack.height = box.height;
  stack.frames.assign(frames.begin(), frames.end());
  stack.levels.resize(stack.pixels() * frames.size());
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const core::Frame frame = clip.Read(frames[t]);
    stack.times_s.push_back(frame.time_s);
    float* const out = stack.levels.data() + t * stack.pixels();
    if (frame.is_16_bit()) {
      Copy<std::uint16_t>(frame, box, out);
    } else {
      Copy<std::uint8_t>(frame, box, out);
    }
  }
  return stack;
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
                       HalveInto(full.of(t), full.width, full.height,
                                 half.levels.data() + t * half.pixels());
                     }
                   });
  return half;
}

std::vector<float> Halve(const std::vector<float>& picture, std::int32_t width,
                         std::int32_t height) {
  std::vector<float> half(static_cast<std::size_t>(width / 2) *
                          static_cast<std::size_t>(height / 2));
  HalveInto(picture.data(), width, height, half.data());
  return half;
}

}  // namespace touchdown::vision::layers
