// Takes frames from a source for a writer and sees to it that all are alike.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <stdexcept>

#include "touchdown/vision/footage/clip_writer.h"

namespace touchdown::vision {

class FrameFeed {
 public:
  explicit FrameFeed(const FrameSource& next) : next_(next) {}

  // The next frame, or nothing at the end. Throws std::invalid_argument if it
  // is empty or unlike the first, or if the first is missing.
  std::optional<core::Frame> Next() {
    std::optional<core::Frame> frame = next_();
    if (!frame) {
      if (count_ == 0) {
        throw std::invalid_argument(
            "frames: there are none, must be at least "
            "one");
      }
      return frame;
    }
    if (count_ == 0) {
      if (frame->data == nullptr || frame->width_px < 1 ||
          frame->height_px < 1 || frame->bit_depth < 1 ||
          frame->bit_depth > 16) {
        throw std::invalid_argument(fmt::format(
            "frame 0 is {}x{} at {} bits, must have pixels of 1 .. 16 bits",
            frame->width_px, frame->height_px, frame->bit_depth));
      }
      first_ = *frame;
    } else if (frame->width_px != first_.width_px ||
               frame->height_px != first_.height_px ||
               frame->bit_depth != first_.bit_depth) {
      throw std::invalid_argument(fmt::format(
          "frame {} is {}x{} at {} bits, must be {}x{} at {} bits like the "
          "first",
          count_, frame->width_px, frame->height_px, frame->bit_depth,
          first_.width_px, first_.height_px, first_.bit_depth));
    }
    ++count_;
    return frame;
  }

  std::int64_t count() const { return count_; }

 private:
  const FrameSource& next_;
  core::Frame first_;
  std::int64_t count_ = 0;
};

// Throws std::invalid_argument unless fps is positive and finite.
void CheckFps(double fps);

}  // namespace touchdown::vision
