// A rendered clip that lies in memory, so that what follows is timed and the
// rendering is not.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "touchdown/vision/footage/clip.h"

namespace touchdown::accuracy {

class KeptClip : public vision::Clip {
 public:
  // Reads `clip` whole.
  explicit KeptClip(vision::Clip& clip) : info_(clip.info()) {
    auto frames = std::make_shared<std::vector<Kept>>();
    for (std::int64_t i = 0; i < info_.frames; ++i) {
      const core::Frame frame = clip.Read(i);
      Kept kept{frame, {}};
      const auto row = static_cast<std::ptrdiff_t>(frame.width_px) *
                       (frame.is_16_bit() ? 2 : 1);
      for (std::int32_t y = 0; y < frame.height_px; ++y) {
        const std::byte* from = frame.data + y * frame.stride_bytes;
        kept.samples.insert(kept.samples.end(), from, from + row);
      }
      kept.view.stride_bytes = row;
      frames->push_back(std::move(kept));
      frames->back().view.data = frames->back().samples.data();
    }
    frames_ = std::move(frames);
  }

  // Another reader of the same frames; with `step` of every step-th one alone,
  // as a camera of fewer frames per second records them.
  std::unique_ptr<KeptClip> Every(std::int64_t step) const {
    auto clip = std::unique_ptr<KeptClip>(new KeptClip(*this, step * step_));
    clip->info_.frames = (info_.frames + step - 1) / step;
    clip->info_.time_base.fps /= static_cast<double>(step);
    return clip;
  }

  const vision::ClipInfo& info() const override { return info_; }
  bool views_last() const override { return true; }
  bool windows_are_cheap() const override { return true; }
  std::unique_ptr<vision::Clip> Another() const override { return Every(1); }

 private:
  struct Kept {
    core::Frame view;
    std::vector<std::byte> samples;
  };

  KeptClip(const KeptClip& other, std::int64_t step)
      : info_(other.info_), frames_(other.frames_), step_(step) {}

  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    core::Frame frame =
        (*frames_)[static_cast<std::size_t>(index * step_)].view;
    frame.data +=
        window.y * frame.stride_bytes +
        static_cast<std::ptrdiff_t>(window.x) * (frame.is_16_bit() ? 2 : 1);
    return frame;
  }

  vision::ClipInfo info_;
  std::shared_ptr<const std::vector<Kept>> frames_;
  std::int64_t step_ = 1;
};

}  // namespace touchdown::accuracy
