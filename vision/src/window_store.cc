#include "window_store.h"

#include <algorithm>
#include <atomic>
#include <optional>
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

// Windows of all frames of a range, and some frames whole.
class WindowStore final : public GrowingClip {
 public:
  WindowStore(std::unique_ptr<Clip> clip, FrameStoreOptions options)
      : clip_(std::move(clip)), options_(std::move(options)) {
    const std::int64_t frames = clip_->info().frames;
    options_.last = options_.last < 0 ? frames : options_.last;
    end_ = options_.first;
    frames_.resize(static_cast<std::size_t>(frames));
    ChooseWholeFrames();
    left_bytes_ = Room();
    scout_.region = options_.region;
    scout_.margin_cells = kMargin;
  }

  bool GrowTo(std::int64_t last) override {
    last = std::min(last, options_.last);
    const bool in_pieces = last < options_.last;
    if (last <= end_ || damaged_) return !damaged_;
    if (in_pieces && !grid_.Begun() && !BeginGrid()) return false;
    try {
      if (!still_) still_ = KeyPicture();
      if (in_pieces) WidenGrid(last);
      Decode(last);
      if (!in_pieces) Finish();
    } catch (const core::InputError&) {
      // What was kept is right; the frame is read again by whoever asks for
      // it, and says then what is wrong.
      damaged_ = true;
    }
    // Some of it through this clip.
    AddReading(clip_->reading_s() - reading_s());
    return !damaged_ && !(in_pieces && is_full_);
  }

  std::vector<std::int64_t> StillFrames() const override {
    if (damaged_) return {};
    return {grid_.frames.begin(), grid_.frames.end()};
  }

  bool HoldsAllChanges() override {
    if (!still_) return false;
    BackgroundOptions background;
    background.among = StillFrames();
    background.threads = options_.threads;
    return IsRight(EstimateBackground(*this, options_.first, end_, background));
  }

  std::int64_t DecodedAgain() const override { return decoded_again_; }

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
    if (index < end_) ++decoded_again_;
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

  bool IsRight(const Background& right) const {
    return !Scout(right, scout_).Differs(Scout(*still_, scout_));
  }

  // What is left for windows beside the whole frames.
  std::size_t Room() const {
    const std::size_t taken = whole_.size() * FrameBytes(info());
    return options_.most_bytes - std::min(options_.most_bytes, taken);
  }

  // Frames kept whole while the clip grows, evenly over what was decoded, so
  // that a background can be made of them wherever it stops: where there are
  // too many, every second one is cut down to its windows.
  struct Grid {
    std::size_t most = 0;  // frames; 0: not begun
    std::int64_t step = 1;
    std::set<std::int64_t> frames;
    bool Begun() const { return most > 0; }
  };

  // False where so few frames would fit that a body leaves its ghost. They take
  // a third more than all else: while the clip grows, a third of the frames
  // that stay whole, those at its end, are not there yet.
  bool BeginGrid() {
    constexpr std::size_t kMost = 33;  // at least half of it at any time
    constexpr std::size_t kLeast = 16;
    const std::size_t fit =
        std::min(kMost, options_.most_bytes / 3 / FrameBytes(info()));
    if (fit < kLeast || !whole_.contains(options_.first)) return false;
    grid_.most = fit;
    return true;
  }

  void WidenGrid(std::int64_t last) {
    const std::int64_t frames = last - options_.first;
    while ((frames + grid_.step - 1) / grid_.step >
           static_cast<std::int64_t>(grid_.most)) {
      grid_.step *= 2;
    }
    std::erase_if(grid_.frames, [this](std::int64_t index) {
      const bool drop = (index - options_.first) % grid_.step != 0;
      if (drop) CutDown(index);
      return drop;
    });
    const std::int64_t past =
        (end_ - options_.first + grid_.step - 1) / grid_.step * grid_.step;
    for (std::int64_t i = options_.first + past; i < last; i += grid_.step) {
      grid_.frames.insert(i);
    }
  }

  // To its windows, unless it stays whole all the same.
  void CutDown(std::int64_t index) {
    if (whole_.contains(index)) return;
    Kept& kept = frames_[static_cast<std::size_t>(index)];
    const std::vector<KeptPixels> whole = std::move(kept.windows);
    kept.windows.clear();
    std::size_t bytes = left_bytes_;
    KeepWindows(whole.front().View(), bytes,
                std::max<std::int64_t>(1, options_.last - end_), kept);
  }

  // All is decoded: as if it had been at once.
  void Finish() {
    const std::set<std::int64_t> frames = std::move(grid_.frames);
    grid_ = {};
    for (const std::int64_t index : frames) CutDown(index);
    // What is still by all samples: a body that waits where the key frames
    // show it would not have been seen.
    Background right = StillPicture();
    if (!IsRight(right)) {
      scout_.always.clear();
      still_ = std::move(right);
      DecodeAgain();
    }
  }

  void DecodeAgain() {
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      if (!whole_.contains(static_cast<std::int64_t>(i))) frames_[i] = {};
    }
    left_bytes_ = Room();
    done_ = 0;
    end_ = options_.first;
    Decode(options_.last);
  }

  // On from end_. Where frames are stored alone, in parts that do not depend on
  // the number of threads.
  void Decode(std::int64_t last) {
    const Scout scout(*still_, scout_);
    const std::int64_t first = end_;
    const std::int64_t frames = last - first;
    const std::size_t room = left_bytes_ * static_cast<std::size_t>(frames) /
                             static_cast<std::size_t>(options_.last - first);
    std::int64_t parts = 1;
    if (AreStoredAlone()) {
      parts = 16;  // enough for the cores of a workstation
      const auto readers =
          std::min<std::int64_t>(core::ThreadsOf(options_.threads), parts);
      while (static_cast<std::int64_t>(others_.size()) + 1 < readers) {
        auto other = clip_->Another();
        if (!other) break;
        others_.push_back(std::move(other));
      }
    }
    std::atomic<std::size_t> next = 0;
    core::InParallel(parts, static_cast<int>(others_.size()) + 1,
                     [&](std::int64_t from, std::int64_t to) {
                       const std::size_t mine = next++;
                       Clip& clip = mine == 0 ? *clip_ : *others_[mine - 1];
                       for (std::int64_t part = from; part < to; ++part) {
                         DecodePart(clip, scout,
                                    {first + part * frames / parts,
                                     first + (part + 1) * frames / parts,
                                     room / static_cast<std::size_t>(parts)});
                       }
                     });
    end_ = last;
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
        if (whole_.contains(index) || grid_.frames.contains(index)) {
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
      if (!TakeRoom(bytes)) {  // it is read again
        is_full_ = true;
        continue;
      }
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
  Grid grid_;
  std::optional<Background> still_;  // that windows differ from
  std::vector<Kept> frames_;
  std::vector<std::unique_ptr<Clip>> others_;  // readers beside clip_
  std::int64_t end_ = 0;                       // [first, end_) is decoded
  bool damaged_ = false;
  std::int64_t decoded_again_ = 0;
  std::atomic<bool> is_full_ = false;  // a window was not kept
  std::atomic<std::size_t> left_bytes_ = 0;
  std::atomic<std::int64_t> done_ = 0;  // frames of this pass, by all readers
};

}  // namespace

std::unique_ptr<GrowingClip> StoreWindows(std::unique_ptr<Clip> clip,
                                          const FrameStoreOptions& options) {
  return std::make_unique<WindowStore>(std::move(clip), options);
}

}  // namespace touchdown::vision
