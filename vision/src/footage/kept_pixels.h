// A copy of a window of a frame.
#pragma once

#include <cstddef>
#include <cstring>
#include <vector>

#include "touchdown/core/frame.h"
#include "touchdown/core/points.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

inline core::PixelRect Whole(const ClipInfo& info) {
  return {0, 0, info.width_px, info.height_px};
}

inline std::size_t FrameBytes(const ClipInfo& info) {
  return static_cast<std::size_t>(info.width_px) *
         static_cast<std::size_t>(info.height_px) *
         (info.bit_depth > 8 ? 2 : 1);
}

inline std::size_t RowBytes(const core::Frame& frame) {
  return static_cast<std::size_t>(frame.width_px) * (frame.is_16_bit() ? 2 : 1);
}

inline std::size_t PixelBytes(const core::Frame& frame) {
  return RowBytes(frame) * static_cast<std::size_t>(frame.height_px);
}

// A window, in coordinates of the recorded picture, of a frame that holds it.
inline core::Frame CutWindow(const core::Frame& frame,
                             const core::PixelRect& window) {
  core::Frame view = frame;
  view.data += (window.y - frame.origin_y_px) * frame.stride_bytes +
               std::ptrdiff_t{window.x - frame.origin_x_px} *
                   (frame.is_16_bit() ? 2 : 1);
  view.width_px = window.width;
  view.height_px = window.height;
  view.origin_x_px = window.x;
  view.origin_y_px = window.y;
  return view;
}

class KeptPixels {
 public:
  KeptPixels() = default;
  explicit KeptPixels(const core::Frame& frame) { Keep(frame); }

  // In the place of what was kept before.
  void Keep(const core::Frame& frame) {
    frame_ = frame;
    pixels_.resize(PixelBytes(frame));
    const std::size_t row_bytes = RowBytes(frame);
    for (std::int32_t y = 0; y < frame.height_px; ++y) {
      std::memcpy(pixels_.data() + static_cast<std::size_t>(y) * row_bytes,
                  frame.row<std::byte>(y), row_bytes);
    }
    frame_.stride_bytes = static_cast<std::ptrdiff_t>(row_bytes);
  }

  bool Holds(const core::PixelRect& window) const {
    return !pixels_.empty() && window.x >= frame_.origin_x_px &&
           window.y >= frame_.origin_y_px &&
           window.x + window.width <= frame_.origin_x_px + frame_.width_px &&
           window.y + window.height <= frame_.origin_y_px + frame_.height_px;
  }

  // A view of a window that it holds; valid as long as this.
  core::Frame View(const core::PixelRect& window) const {
    core::Frame whole = frame_;
    whole.data = pixels_.data();
    return CutWindow(whole, window);
  }
  core::Frame View() const {
    return View({frame_.origin_x_px, frame_.origin_y_px, frame_.width_px,
                 frame_.height_px});
  }

 private:
  core::Frame frame_;  // its data is set when it is handed out
  std::vector<std::byte> pixels_;
};

}  // namespace touchdown::vision
