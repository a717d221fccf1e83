// Clips made of others, for what a single scene cannot show.
#pragma once

#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "touchdown/core/errors.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision::synthetic {

// The darker of two clips, pixel by pixel: two dark bodies in one picture. Both
// of 8 bits and of one size.
class Darker : public Clip {
 public:
  Darker(std::unique_ptr<Clip> a, std::unique_ptr<Clip> b)
      : a_(std::move(a)), b_(std::move(b)) {}
  const ClipInfo& info() const override { return a_->info(); }

 private:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    core::Frame frame = a_->Read(index, window);
    const core::Frame other = b_->Read(index, window);
    const auto width = static_cast<std::size_t>(frame.width_px);
    pixels_.resize(width * static_cast<std::size_t>(frame.height_px));
    for (std::int32_t y = 0; y < frame.height_px; ++y) {
      for (std::int32_t x = 0; x < frame.width_px; ++x) {
        pixels_[static_cast<std::size_t>(y) * width +
                static_cast<std::size_t>(x)] =
            static_cast<std::byte>(std::min(frame.at(x, y), other.at(x, y)));
      }
    }
    frame.data = pixels_.data();
    frame.stride_bytes = static_cast<std::ptrdiff_t>(width);
    return frame;
  }

  std::unique_ptr<Clip> a_;
  std::unique_ptr<Clip> b_;
  std::vector<std::byte> pixels_;
};

// A clip whose frames from `from` on are damaged.
class Damaged : public Clip {
 public:
  Damaged(std::unique_ptr<Clip> clip, std::int64_t from)
      : clip_(std::move(clip)), from_(from) {}
  const ClipInfo& info() const override { return clip_->info(); }

 private:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    if (index >= from_) {
      throw core::InputError("test: frame " + std::to_string(index) +
                             " is damaged");
    }
    return clip_->Read(index, window);
  }

  std::unique_ptr<Clip> clip_;
  std::int64_t from_;
};

}  // namespace touchdown::vision::synthetic
