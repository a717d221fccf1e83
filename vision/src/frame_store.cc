#include "touchdown/vision/frame_store.h"

#include <cstring>
#include <utility>
#include <vector>

namespace touchdown::vision {
namespace {

class FrameStore : public Clip {
 public:
  FrameStore(std::unique_ptr<Clip> clip, const FrameStoreOptions& options)
      : clip_(std::move(clip)),
        left_bytes_(options.most_bytes),
        kept_(static_cast<std::size_t>(clip_->info().frames)) {}

  const ClipInfo& info() const override { return clip_->info(); }

 private:
  struct Kept {
    std::vector<std::byte> pixels;
    core::Frame frame;  // of the whole picture; data set when handed out
  };

  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    Kept& kept = kept_[static_cast<std::size_t>(index)];
    if (kept.pixels.empty()) {
      const core::Frame frame = clip_->Read(index);
      const std::size_t row_bytes = static_cast<std::size_t>(frame.width_px) *
                                    (frame.is_16_bit() ? 2 : 1);
      const std::size_t bytes =
          row_bytes * static_cast<std::size_t>(frame.height_px);
      if (bytes > left_bytes_) return clip_->Read(index, window);
      left_bytes_ -= bytes;
      kept.pixels.resize(bytes);
      for (std::int32_t y = 0; y < frame.height_px; ++y) {
        std::memcpy(
            kept.pixels.data() + static_cast<std::size_t>(y) * row_bytes,
            frame.row<std::byte>(0) + y * frame.stride_bytes, row_bytes);
      }
      kept.frame = frame;
      kept.frame.stride_bytes = static_cast<std::ptrdiff_t>(row_bytes);
    }
    core::Frame view = kept.frame;
    view.data =
        kept.pixels.data() + window.y * view.stride_bytes +
        static_cast<std::ptrdiff_t>(window.x) * (view.is_16_bit() ? 2 : 1);
    view.width_px = window.width;
    view.height_px = window.height;
    view.origin_x_px = window.x;
    view.origin_y_px = window.y;
    return view;
  }

  std::unique_ptr<Clip> clip_;
  std::size_t left_bytes_;
  std::vector<Kept> kept_;
};

}  // namespace

std::unique_ptr<Clip> KeepFrames(std::unique_ptr<Clip> clip,
                                 const FrameStoreOptions& options) {
  if (clip->info().format == "mraw") return clip;
  return std::make_unique<FrameStore>(std::move(clip), options);
}

}  // namespace touchdown::vision
