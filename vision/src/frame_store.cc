#include "touchdown/vision/frame_store.h"

#include <algorithm>
#include <atomic>
#include <set>
#include <utility>
#include <vector>

#include "first_look.h"
#include "kept_pixels.h"
#include "scout.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/parallel.h"
#include "touchdown/vision/background.h"

namespace touchdown::vision {
namespace {

std::size_t FrameBytes(const ClipInfo& info) {
  return static_cast<std::size_t>(info.width_px) *
         static_cast<std::size_t>(info.height_px) *
         (info.bit_depth > 8 ? 2 : 1);
}

core::PixelRect Whole(const ClipInfo& info) {
  return {0, 0, info.width_px, info.height_px};
}

// Every frame that is read is kept whole as long as there is room. Where frames
// are stored one upon the other, those on the way are kept, too.
class FrameStore final : public Clip {
 public:
  FrameStore(std::unique_ptr<Clip> clip, std::size_t most_bytes)
      : clip_(std::move(clip)),
        left_bytes_(most_bytes),
        kept_(static_cast<std::size_t>(clip_->info().frames)) {}

  const ClipInfo& info() const override { return clip_->info(); }

 private:
  KeptPixels& KeptOf(std::int64_t index) {
    return kept_[static_cast<std::size_t>(index)];
  }

  // True if frame `index` is kept now.
  bool Keep(std::int64_t index) {
    KeptPixels& kept = KeptOf(index);
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
    if (KeptOf(index).Holds(window)) return KeptOf(index).View(window);
    for (std::int64_t on_way = clip_->EntryFrame(index); on_way < index;
         ++on_way) {
      try {
        if (!Keep(on_way)) break;
      } catch (const core::InputError&) {
        // It is for whoever asks for that frame.
      }
    }
    if (!Keep(index)) return clip_->Read(index, window);
    return KeptOf(index).View(window);
  }

  std::unique_ptr<Clip> clip_;
  std::size_t left_bytes_;
  std::vector<KeptPixels> kept_;
};

// Windows of all frames of a range, and some frames whole.
class WindowStore final : public Clip {
 public:
  WindowStore(std::unique_ptr<Clip> clip, FrameStoreOptions options)
      : clip_(std::move(clip)), options_(std::move(options)) {
    const std::int64_t frames = clip_->info().frames;
    options_.last = options_.last < 0 ? frames : options_.last;
    frames_.resize(static_cast<std::size_t>(frames));
    ChooseWholeFrames();
    scout_.region = options_.region;
    scout_.margin_cells = kMargin;
    try {
      const Background still = KeyPicture();
      Decode(still);
      // What is still by all samples: a body that waits where the key frames
      // show it would not have been seen.
      const Background right = StillPicture();
      if (Scout(right, scout_).Differs(Scout(still, scout_))) {
        scout_.always.clear();
        Decode(right);
      }
    } catch (const core::InputError&) {
      // Damaged: what was kept is right; the frame is read again by whoever
      // asks for it, and says then what is wrong.
    }
    // Some of it through this clip.
    AddReading(clip_->reading_s() - reading_s());
  }

  const ClipInfo& info() const override { return clip_->info(); }
  std::int64_t EntryFrame(std::int64_t index) const override {
    return clip_->EntryFrame(index);
  }
  const Changes* ChangesIn(std::int64_t index) const override {
    const Kept& kept = frames_[static_cast<std::size_t>(index)];
    return kept.seen ? &kept.changes : nullptr;
  }

 private:
  // 32 px around what differs: what the fit of a body of 50 px looks at.
  static constexpr std::int32_t kMargin = 2;

  struct Kept {
    bool seen = false;
    Changes changes;
    std::vector<KeptPixels> windows;  // the whole picture, or one a change
  };

  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    for (const KeptPixels& kept :
         frames_[static_cast<std::size_t>(index)].windows) {
      if (kept.Holds(window)) return kept.View(window);
    }
    return clip_->Read(index, window);
  }

  // Those of the backgrounds that first_look.cc may ask for: of the whole
  // range, and, where there is room, of its first and last eighth.
  void ChooseWholeFrames() {
    const std::int64_t first = options_.first;
    const std::int64_t last = options_.last;
    const std::int64_t part = EndPart(first, last);
    const std::size_t room = options_.most_bytes * 3 / 5;
    for (const auto& [from, to] :
         {std::pair{first, last},
          std::pair{first, std::min(first + part, last)},
          std::pair{std::max(first, last - part), last}}) {
      std::set<std::int64_t> more = whole_;
      more.merge(
          SetOf(BackgroundFrames(from, to, BackgroundOptions{}.samples)));
      if (more.size() * FrameBytes(info()) > room) break;
      whole_ = std::move(more);
    }
  }
  static std::set<std::int64_t> SetOf(const std::vector<std::int64_t>& frames) {
    return {frames.begin(), frames.end()};
  }

  // Of frames that can be read without others.
  Background KeyPicture() {
    std::set<std::int64_t> keys;
    for (const std::int64_t frame : BackgroundFrames(
             options_.first, options_.last, BackgroundOptions{}.samples)) {
      keys.insert(clip_->EntryFrame(frame));
    }
    keys.erase(keys.begin(), keys.lower_bound(options_.first));
    if (keys.empty()) keys.insert(options_.first);
    const std::vector<std::int64_t> frames(keys.begin(), keys.end());
    for (const std::int64_t frame : frames) {
      if (!whole_.contains(frame)) continue;
      frames_[static_cast<std::size_t>(frame)].windows.emplace_back(
          clip_->Read(frame));
    }
    BackgroundOptions background;
    background.threads = options_.threads;
    Background still = BackgroundOf(*this, frames, background);
    // A mid-mean of up to three is a mean: where they differ, any of them may
    // show the body, and all frames are kept there.
    constexpr std::size_t kRobust = 4;
    if (frames.size() < kRobust) {
      const Scout scout(still, scout_);
      for (const std::int64_t frame : frames) {
        const Changes changes = scout.Look(Read(frame));
        scout_.always.insert(scout_.always.end(), changes.where.begin(),
                             changes.where.end());
      }
    }
    return still;
  }

  Background StillPicture() {
    BackgroundOptions background;
    background.threads = options_.threads;
    return EstimateBackground(*this, options_.first, options_.last, background);
  }

  // One pass over the range. Where frames are stored alone, in parts that do
  // not depend on the number of threads.
  void Decode(const Background& still) {
    const Scout scout(still, scout_);
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      if (!whole_.contains(static_cast<std::int64_t>(i))) frames_[i] = {};
    }
    const std::size_t whole_bytes = whole_.size() * FrameBytes(info());
    const std::size_t room =
        options_.most_bytes - std::min(options_.most_bytes, whole_bytes);
    left_bytes_ = room;
    done_ = 0;
    const std::int64_t frames = options_.last - options_.first;
    std::int64_t parts = 1;
    std::vector<std::unique_ptr<Clip>> others;
    if (AreStoredAlone()) {
      parts = 16;  // enough for the cores of a workstation
      const auto readers =
          std::min<std::int64_t>(core::ThreadsOf(options_.threads), parts);
      while (static_cast<std::int64_t>(others.size()) + 1 < readers) {
        auto other = clip_->Another();
        if (!other) break;
        others.push_back(std::move(other));
      }
    }
    std::atomic<std::size_t> next = 0;
    core::InParallel(parts, static_cast<int>(others.size()) + 1,
                     [&](std::int64_t from, std::int64_t to) {
                       const std::size_t mine = next++;
                       Clip& clip = mine == 0 ? *clip_ : *others[mine - 1];
                       for (std::int64_t part = from; part < to; ++part) {
                         DecodePart(
                             clip, scout,
                             {options_.first + part * frames / parts,
                              options_.first + (part + 1) * frames / parts,
                              room / static_cast<std::size_t>(parts)});
                       }
                     });
  }

  bool AreStoredAlone() const {
    for (std::int64_t i = options_.first; i < options_.last; ++i) {
      if (clip_->EntryFrame(i) != i) return false;
    }
    return true;
  }

  struct Part {
    std::int64_t first = 0;
    std::int64_t last = 0;
    std::size_t bytes = 0;  // its share of the room
  };

  void DecodePart(Clip& clip, const Scout& scout, Part part) {
    const core::PixelRect whole = Whole(info());
    for (std::int64_t index = part.first; index < part.last; ++index) {
      Kept& kept = frames_[static_cast<std::size_t>(index)];
      const bool is_here =
          !kept.windows.empty() && kept.windows.front().Holds(whole);
      const core::Frame frame =
          is_here ? kept.windows.front().View() : clip.Read(index);
      kept.changes = scout.Look(frame);
      kept.seen = true;
      if (!is_here) {
        if (whole_.contains(index)) {
          kept.windows.emplace_back(frame);
        } else {
          KeepWindows(frame, part.bytes, part.last - index, kept);
        }
      }
      const std::int64_t done = ++done_;
      if (options_.progress && &clip == clip_.get()) {
        options_.progress(static_cast<double>(done) /
                          static_cast<double>(options_.last - options_.first));
      }
    }
  }

  // The strongest window in any case, the others as far as each frame's share
  // of the part's bytes goes: those that are not kept are not changes.
  void KeepWindows(const core::Frame& frame, std::size_t& part_bytes,
                   std::int64_t frames, Kept& kept) {
    std::size_t share = part_bytes / static_cast<std::size_t>(frames);
    std::vector<core::PixelRect>& where = kept.changes.where;
    std::vector<core::PixelRect> held;
    for (const core::PixelRect& rect : where) {
      const core::Frame window = WindowOf(frame, rect);
      const std::size_t bytes = PixelBytes(window);
      if (!held.empty() && bytes > share) continue;
      held.push_back(rect);
      share -= std::min(share, bytes);
      part_bytes -= std::min(part_bytes, bytes);
      if (!TakeRoom(bytes)) continue;  // it is read again
      kept.windows.emplace_back(window);
    }
    where = std::move(held);
  }

  // Of the room of all parts; false if there is not so much.
  bool TakeRoom(std::size_t bytes) {
    std::size_t left = left_bytes_;
    while (bytes <= left) {
      if (left_bytes_.compare_exchange_weak(left, left - bytes)) return true;
    }
    return false;
  }

  std::unique_ptr<Clip> clip_;
  FrameStoreOptions options_;
  ScoutOptions scout_;
  std::set<std::int64_t> whole_;
  std::vector<Kept> frames_;
  std::atomic<std::size_t> left_bytes_ = 0;
  std::atomic<std::int64_t> done_ = 0;  // frames of this pass, by all readers
};

}  // namespace

std::unique_ptr<Clip> KeepFrames(std::unique_ptr<Clip> clip,
                                 const FrameStoreOptions& options) {
  const ClipInfo& info = clip->info();
  if (info.format == "mraw") return clip;
  const std::int64_t last = options.last < 0 ? info.frames : options.last;
  const auto frames = static_cast<std::size_t>(last - options.first);
  // A few frames are decoded again rather than looked at for windows.
  constexpr std::size_t kFew = 100;
  if (frames <= kFew || FrameBytes(info) <= options.most_bytes / frames) {
    return std::make_unique<FrameStore>(std::move(clip), options.most_bytes);
  }
  return std::make_unique<WindowStore>(std::move(clip), options);
}

}  // namespace touchdown::vision
