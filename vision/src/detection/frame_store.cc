#include "touchdown/vision/detection/frame_store.h"

#include <utility>
#include <vector>

#include "detection/window_store.h"
#include "footage/kept_pixels.h"
#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

// Keeps every frame that is read whole, as long as there is room. Where a frame
// needs others to be decoded, those on the way are kept, too.
class FrameStore final : public GrowingClip {
 public:
  FrameStore(std::unique_ptr<Clip> clip, std::int64_t last,
             std::size_t most_bytes)
      : clip_(std::move(clip)),
        last_(last),
        left_bytes_(most_bytes),
        kept_(static_cast<std::size_t>(clip_->info().frames)) {
    set_cancellation(clip_->cancellation());
  }

  const ClipInfo& info() const override { return clip_->info(); }
  // It decodes when it is asked for a frame.
  bool ExtendDecoding(std::int64_t last) override { return last >= last_; }
  std::vector<std::int64_t> StillFrames() const override { return {}; }
  bool HoldsAllChanges() override { return true; }
  std::vector<std::pair<std::int64_t, std::int64_t>> LeftOut() const override {
    return {};
  }
  std::int64_t DecodedAgain() const override { return decoded_again_; }

 private:
  KeptPixels& KeptFrame(std::int64_t index) {
    return kept_[static_cast<std::size_t>(index)];
  }

  // Reads and keeps frame `index`; false where there is no room.
  bool Keep(std::int64_t index) {
    KeptPixels& kept = KeptFrame(index);
    const core::PixelRect whole = Whole(info());
    if (kept.Holds(whole)) return true;
    const std::size_t bytes = FrameBytes(info());
    if (bytes > left_bytes_) return false;
    kept = KeptPixels(clip_->Read(index));
    left_bytes_ -= bytes;
    return true;
  }

  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    if (KeptFrame(index).Holds(window)) return KeptFrame(index).View(window);
    for (std::int64_t on_way = clip_->EntryFrame(index); on_way < index;
         ++on_way) {
      try {
        if (!Keep(on_way)) break;
      } catch (const core::InputError&) {
        // It is for whoever asks for that frame.
      }
    }
    if (!Keep(index)) {
      ++decoded_again_;
      return clip_->Read(index, window);
    }
    return KeptFrame(index).View(window);
  }

  std::unique_ptr<Clip> clip_;
  std::int64_t last_;
  std::size_t left_bytes_;
  std::vector<KeptPixels> kept_;
  std::int64_t decoded_again_ = 0;
};

}  // namespace

std::unique_ptr<GrowingClip> GrowFrames(std::unique_ptr<Clip> clip,
                                        const FrameStoreOptions& options) {
  const ClipInfo& info = clip->info();
  const std::int64_t last = options.last < 0 ? info.frames : options.last;
  const auto frames = static_cast<std::size_t>(last - options.first);
  // Frames. So few are decoded again rather than searched for windows: the
  // search needs the background first. Not studied.
  constexpr std::size_t kFewFrames = 100;
  if (frames <= kFewFrames || FrameBytes(info) <= options.most_bytes / frames) {
    return std::make_unique<FrameStore>(std::move(clip), last,
                                        options.most_bytes);
  }
  return StoreWindows(std::move(clip), options);
}

std::unique_ptr<Clip> KeepFrames(std::unique_ptr<Clip> clip,
                                 const FrameStoreOptions& options) {
  if (clip->info().format == "mraw") return clip;
  auto kept = GrowFrames(std::move(clip), options);
  kept->ExtendDecoding(kept->info().frames);
  return kept;
}

}  // namespace touchdown::vision
