// Clips that a function draws, for bodies that no scene can describe.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision::synthetic {

// 8 bits; time zero is frame 0.
class DrawnClip : public Clip {
 public:
  // The whole picture of a frame, DN, row by row, into an empty list.
  using Draw =
      std::function<void(std::int64_t frame, std::vector<double>& levels)>;

  DrawnClip(std::int32_t width_px, std::int32_t height_px, std::int64_t frames,
            double fps, Draw draw)
      : draw_(std::move(draw)) {
    info_.width_px = width_px;
    info_.height_px = height_px;
    info_.frames = frames;
    info_.time_base.fps = fps;
  }
  const ClipInfo& info() const override { return info_; }

 private:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    if (index != drawn_) {
      std::vector<double> levels;
      draw_(index, levels);
      pixels_.clear();
      for (const double level : levels) {
        pixels_.push_back(
            static_cast<std::byte>(std::lround(std::clamp(level, 0.0, 255.0))));
      }
      drawn_ = index;
    }
    core::Frame frame;
    frame.data = pixels_.data() +
                 static_cast<std::ptrdiff_t>(window.y) * info_.width_px +
                 window.x;
    frame.stride_bytes = info_.width_px;
    frame.width_px = window.width;
    frame.height_px = window.height;
    frame.time_s = static_cast<double>(index) / info_.time_base.fps;
    return frame;
  }

  ClipInfo info_;
  Draw draw_;
  std::int64_t drawn_ = -1;
  std::vector<std::byte> pixels_;
};

}  // namespace touchdown::vision::synthetic
