#include "touchdown/vision/footage/decoded_once.h"

#include <memory>
#include <unordered_map>
#include <utility>

#include "footage/kept_pixels.h"

namespace touchdown::vision {
namespace {

class DecodedOnce final : public Clip {
 public:
  DecodedOnce(std::unique_ptr<Clip> clip, const DecodedOnceOptions& options)
      : clip_(std::move(clip)),
        most_frames_(options.most_bytes / FrameBytes(clip_->info())),
        looks_(options.looks) {
    set_cancellation(clip_->cancellation());
  }

  const ClipInfo& info() const override { return clip_->info(); }
  void WillRead(std::int64_t index, const core::PixelRect& window) override {
    clip_->WillRead(index, window);
  }
  void WillReadOnce(std::int64_t index,
                    const core::PixelRect& window) override {
    clip_->WillReadOnce(index, window);
  }
  void HasRead() const override { clip_->HasRead(); }
  void RequireWhole() const override { clip_->RequireWhole(); }
  std::int64_t EntryFrame(std::int64_t index) const override {
    return clip_->EntryFrame(index);
  }
  std::unique_ptr<Clip> Another() const override { return clip_->Another(); }

 protected:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    const auto kept = kept_.find(index);
    if (kept != kept_.end()) return kept->second.View(window);
    if (kept_.size() >= most_frames_ || (looks_ && !*looks_)) {
      return clip_->Read(index, window);
    }
    return kept_.emplace(index, clip_->Read(index)).first->second.View(window);
  }

 private:
  std::unique_ptr<Clip> clip_;
  std::size_t most_frames_;
  std::shared_ptr<const bool> looks_;
  std::unordered_map<std::int64_t, KeptPixels> kept_;
};

}  // namespace

std::unique_ptr<Clip> DecodeOnce(std::unique_ptr<Clip> clip,
                                 const DecodedOnceOptions& options) {
  if (clip->windows_are_cheap()) return clip;
  return std::make_unique<DecodedOnce>(std::move(clip), options);
}

}  // namespace touchdown::vision
