// A clip with another's pictures changed one by one, held in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "touchdown/vision/footage/clip.h"

namespace touchdown::pipeline::filmed {

// Sample (x, y) of frame `index` of the changed clip, given a look-up of the
// other's samples.
using SampleOf =
    std::function<std::uint32_t(std::int64_t, std::int32_t, std::int32_t)>;
using Change = std::function<std::uint32_t(const SampleOf& of, std::int64_t,
                                           std::int32_t, std::int32_t)>;

class ChangedClip : public vision::Clip {
 public:
  ChangedClip(std::unique_ptr<vision::Clip> clip, const Change& change)
      : info_(clip->info()) {
    std::vector<std::vector<std::uint32_t>> before;
    for (std::int64_t i = 0; i < info_.frames; ++i) {
      const core::Frame frame = clip->Read(i);
      auto& samples = before.emplace_back();
      for (std::int32_t y = 0; y < info_.height_px; ++y) {
        for (std::int32_t x = 0; x < info_.width_px; ++x) {
          samples.push_back(frame.at(x, y));
        }
      }
    }
    const SampleOf of = [&](std::int64_t i, std::int32_t x, std::int32_t y) {
      return before[static_cast<std::size_t>(i)][At(x, y)];
    };
    for (std::int64_t i = 0; i < info_.frames; ++i) {
      auto& samples = frames_.emplace_back();
      for (std::int32_t y = 0; y < info_.height_px; ++y) {
        for (std::int32_t x = 0; x < info_.width_px; ++x) {
          samples.push_back(static_cast<std::uint16_t>(change(of, i, x, y)));
        }
      }
    }
  }

  const vision::ClipInfo& info() const override { return info_; }

 private:
  std::size_t At(std::int32_t x, std::int32_t y) const {
    return static_cast<std::size_t>(y) *
               static_cast<std::size_t>(info_.width_px) +
           static_cast<std::size_t>(x);
  }

  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    const auto& samples = frames_[static_cast<std::size_t>(index)];
    bytes_.clear();
    for (std::int32_t y = window.y; y < window.y + window.height; ++y) {
      for (std::int32_t x = window.x; x < window.x + window.width; ++x) {
        const std::uint16_t value = samples[At(x, y)];
        bytes_.push_back(static_cast<std::byte>(value & 0xff));
        if (info_.bit_depth > 8) {
          bytes_.push_back(static_cast<std::byte>(value >> 8));
        }
      }
    }
    core::Frame frame;
    frame.data = bytes_.data();
    frame.bit_depth = info_.bit_depth;
    frame.stride_bytes =
        std::ptrdiff_t{window.width} * (info_.bit_depth > 8 ? 2 : 1);
    frame.time_s = static_cast<double>(index) / info_.time_base.fps;
    return frame;
  }

  vision::ClipInfo info_;
  std::vector<std::vector<std::uint16_t>> frames_;
  std::vector<std::byte> bytes_;
};

}  // namespace touchdown::pipeline::filmed
