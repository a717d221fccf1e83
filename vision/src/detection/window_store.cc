#include "detection/window_store.h"

#include <algorithm>
#include <atomic>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "detection/frame_choice.h"
#include "detection/glimpses.h"
#include "detection/scout.h"
#include "footage/kept_pixels.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/parallel.h"
#include "touchdown/vision/background/background.h"

namespace touchdown::vision {
namespace {

// Keeps windows around what changes, in the frames that are worth decoding, and
// some frames whole (for backgrounds). Decodes once, in pieces or all at once.
class WindowStore final : public GrowingClip {
 public:
  WindowStore(std::unique_ptr<Clip> clip, FrameStoreOptions options)
      : clip_(std::move(clip)), options_(std::move(options)) {
    set_cancellation(clip_->cancellation());
    const std::int64_t frames = clip_->info().frames;
    options_.last = options_.last < 0 ? frames : options_.last;
    end_ = options_.first;
    frames_.resize(static_cast<std::size_t>(frames));
    whole_ = FramesKeptWhole(info(), options_);
    alone_ = AreStoredAlone(*clip_, options_.first, options_.last);
    left_bytes_ = Room();
    scout_.region = options_.region;
    scout_.margin_cells = kMarginCells;
  }

  // In pieces while the clip grows; the last piece ends as if all had been
  // decoded at once, so that the result does not depend on the pieces.
  bool ExtendDecoding(std::int64_t last) override {
    last = std::min(last, options_.last);
    const bool in_pieces = last < options_.last;
    if (last <= end_ || damaged_) return !damaged_;
    if (in_pieces && !grid_.Begun() && !BeginGrid()) return false;
    try {
      if (!still_) LookAtKeyFrames();
      if (in_pieces) {
        if (end_ == options_.first) ChooseByKeys();
        WidenGrid(last);
        AdvanceDecoder(last);
      } else {
        DecodeAll();
        Finish();
      }
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
    BackgroundOptions background;
    background.among = StillFrames();
    if (!still_ || (end_ < options_.last && background.among.empty())) {
      return false;
    }
    background.threads = options_.threads;
    return IsRight(EstimateBackground(*this, options_.first, end_, background));
  }

  std::vector<std::pair<std::int64_t, std::int64_t>> LeftOut() const override {
    std::vector<std::pair<std::int64_t, std::int64_t>> ranges;
    for (std::int64_t i = options_.first; i < end_; ++i) {
      if (KeptFrame(i).state != State::kLeftOut) continue;
      // What was glimpsed at within a range is part of it.
      // Frames: a probe and the frame after it.
      constexpr std::int64_t kProbeFrames = 2;
      if (ranges.empty() || ranges.back().second + kProbeFrames < i) {
        ranges.emplace_back(i, i);
      }
      ranges.back().second = i + 1;
    }
    return ranges;
  }

  std::int64_t DecodedAgain() const override { return decoded_again_; }

  const ClipInfo& info() const override { return clip_->info(); }
  std::int64_t EntryFrame(std::int64_t index) const override {
    return clip_->EntryFrame(index);
  }
  const Changes* KnownChanges(std::int64_t index) const override {
    const Kept& kept = KeptFrame(index);
    // What was glimpsed at is not among them yet.
    const bool grown = index < end_ || damaged_;
    return grown && kept.state != State::kUnknown ? &kept.changes : nullptr;
  }

 private:
  // Cells, 32 px, around what differs: what the fit of a body of 50 px looks
  // at. More costs memory; less reads frames again. Not studied.
  static constexpr std::int32_t kMarginCells = 2;

  // Left out: glimpses near it show nothing.
  enum class State { kUnknown, kLeftOut, kSeen };

  struct Kept {
    State state = State::kUnknown;
    Changes changes;
    std::vector<KeptPixels> windows;  // the whole picture, or one a change
  };

  Kept& KeptFrame(std::int64_t index) {
    return frames_[static_cast<std::size_t>(index)];
  }
  const Kept& KeptFrame(std::int64_t index) const {
    return frames_[static_cast<std::size_t>(index)];
  }

  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    for (const KeptPixels& kept : KeptFrame(index).windows) {
      if (kept.Holds(window)) return kept.View(window);
    }
    if (index < end_) ++decoded_again_;
    return clip_->Read(index, window);
  }

  // Makes a first still picture of the key frames, and notes which of them show
  // anything beside it.
  void LookAtKeyFrames() {
    keys_ = ChooseKeyFrames(*clip_, options_.first, options_.last);
    const bool fit = keys_.size() * FrameBytes(info()) <= options_.most_bytes;
    for (const std::int64_t frame : keys_) {
      if (!fit && !whole_.contains(frame)) continue;
      KeptFrame(frame).windows.emplace_back(clip_->Read(frame));
    }
    BackgroundOptions background;
    background.threads = options_.threads;
    still_ = EstimateBackgroundFromFrames(*this, keys_, background);
    // Frames. An interquartile mean of up to three is a mean: where they
    // differ, any of them may show the body, and all frames are kept there.
    constexpr std::size_t kMinRobust = 4;
    const Scout scout(*still_, scout_);
    for (const std::int64_t frame : keys_) {
      const Changes changes = scout.Look(Read(frame));
      keys_changes_.push_back(changes);
      if (keys_.size() >= kMinRobust) continue;
      scout_.always.insert(scout_.always.end(), changes.where.begin(),
                           changes.where.end());
    }
    for (const std::int64_t frame : keys_) {
      if (!whole_.contains(frame)) KeptFrame(frame).windows.clear();
    }
  }

  Background StillPicture() {
    BackgroundOptions background;
    background.threads = options_.threads;
    return EstimateBackground(*this, options_.first, options_.last, background);
  }

  // Whether windows that were cut by the first still picture would have been
  // the same by a better one.
  bool IsRight(const Background& right) const {
    return !Scout(right, scout_).Differs(Scout(*still_, scout_));
  }

  // What is left for windows beside the whole frames.
  std::size_t Room() const {
    const std::size_t taken = whole_.size() * FrameBytes(info());
    return options_.most_bytes - std::min(options_.most_bytes, taken);
  }

  // Frames kept whole while the clip grows, evenly over what was decoded, so
  // that a background can be made of them wherever decoding stops. Where there
  // are too many, every second one is cut down to its windows.
  struct Grid {
    std::size_t most = 0;  // frames; 0: not begun
    std::size_t step = 1;
    std::set<std::int64_t> frames;
    bool Begun() const { return most > 0; }
  };

  // Returns false where so few frames would fit that a body leaves its ghost.
  // They take a third more memory than all else: while the clip grows, a third
  // of the frames that stay whole, those at its end, are not there yet.
  bool BeginGrid() {
    // Frames: halving leaves at least half of them at any time. A background of
    // fewer than 16 keeps a body's ghost. Not studied.
    constexpr std::size_t kMaxGrid = 33;
    constexpr std::size_t kMinGrid = 16;
    const std::size_t fit =
        std::min(kMaxGrid, options_.most_bytes / 3 / FrameBytes(info()));
    if (fit < kMinGrid || !whole_.contains(options_.first)) return false;
    grid_.most = fit;
    return true;
  }

  // Adds every step-th of the frames up to `last`; doubles the step when they
  // are too many.
  void WidenGrid(std::int64_t last) {
    const std::size_t frames = CountEarlierFrames(last);
    while ((frames + grid_.step - 1) / grid_.step > grid_.most) grid_.step *= 2;
    std::erase_if(grid_.frames, [this](std::int64_t index) {
      const bool drop = CountEarlierFrames(index) % grid_.step != 0;
      if (drop) CutDown(index);
      return drop;
    });
    for (std::size_t i = (next_ + grid_.step - 1) / grid_.step * grid_.step;
         i < frames; i += grid_.step) {
      grid_.frames.insert(todo_[i]);
    }
  }

  // How many of those to decode lie before frame `index`.
  std::size_t CountEarlierFrames(std::int64_t index) const {
    return static_cast<std::size_t>(
        std::lower_bound(todo_.begin(), todo_.end(), index) - todo_.begin());
  }

  // Cuts a whole frame down to its windows, unless it stays whole for a
  // background.
  void CutDown(std::int64_t index) {
    if (whole_.contains(index)) return;
    Kept& kept = KeptFrame(index);
    const std::vector<KeptPixels> whole = std::move(kept.windows);
    kept.windows.clear();
    std::size_t bytes = left_bytes_;
    KeepWindows(whole.front().View(), bytes,
                std::max<std::size_t>(1, todo_.size() - next_), kept);
  }

  // While the clip grows, key frames are the probes: what lies between two that
  // show nothing is left out, however far apart they are. Where nothing is
  // known to be still, all is decoded.
  void ChooseByKeys() {
    GlimpseRule rule;
    rule.most_between = options_.most_between_keys;
    rule.reach = 0;
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      KeptFrame(keys_[k]).changes = std::move(keys_changes_[k]);
    }
    keys_changes_.clear();
    const std::vector<bool> show =
        scout_.always.empty()
            ? Shows(keys_,
                    static_cast<std::size_t>(options_.last - options_.first))
            : std::vector<bool>(keys_.size(), true);
    todo_ = NotSeen(
        FramesWorthDecoding(options_.first, options_.last, keys_, show, rule));
  }

  // All at once: probes, then the frames that may show anything and those that
  // backgrounds are made of. What was seen before is not decoded again.
  void DecodeAll() {
    for (Kept& kept : frames_) {
      if (kept.state == State::kLeftOut) kept.state = State::kUnknown;
    }
    const GlimpseRule rule;
    const std::int64_t range = options_.last - options_.first;
    std::vector<std::int64_t> glimpsed;
    // Probes are in vain where other frames would have to be decoded for them,
    // or where it is not known what is still.
    if (alone_ && scout_.always.empty()) {
      for (std::int64_t i = options_.first; i < options_.last;
           i += kGlimpseStride) {
        glimpsed.push_back(i);
      }
    }
    done_ = Seen();
    Decode(NotSeen(glimpsed), static_cast<std::size_t>(range));
    const std::vector<std::int64_t> seen = FramesWorthDecoding(
        options_.first, options_.last, glimpsed,
        Shows(glimpsed, static_cast<std::size_t>(range)), rule);
    std::set<std::int64_t> worth(seen.begin(), seen.end());
    worth.insert(whole_.begin(), whole_.end());
    const std::vector<std::int64_t> rest =
        NotSeen({worth.begin(), worth.end()});
    done_ = range - static_cast<std::int64_t>(rest.size());
    Decode(rest, rest.size());
    end_ = options_.first;
    LeaveOutFrames(options_.last);
  }

  // Which of the probed frames show something. Where frames are stored alone,
  // the frame after each that differs is decoded, too, since noise differs in
  // one only; else that would cost one more decoding from the key frame.
  std::vector<bool> Shows(const std::vector<std::int64_t>& glimpsed,
                          std::size_t range) {
    std::vector<std::int64_t> next;
    for (const std::int64_t index : glimpsed) {
      const bool differs = !KeptFrame(index).changes.where.empty();
      if (alone_ && differs && index + 1 < options_.last) {
        next.push_back(index + 1);
      }
    }
    Decode(NotSeen(std::move(next)), range);
    std::vector<bool> shows;
    shows.reserve(glimpsed.size());
    for (const std::int64_t index : glimpsed) {
      const Changes& changes = KeptFrame(index).changes;
      shows.push_back(
          !alone_ || index + 1 == options_.last
              ? !changes.where.empty()
              : AreInBoth(changes, KeptFrame(index + 1).changes, kMarginCells));
    }
    return shows;
  }

  std::vector<std::int64_t> NotSeen(std::vector<std::int64_t> frames) const {
    std::erase_if(frames, [this](std::int64_t index) {
      return KeptFrame(index).state == State::kSeen;
    });
    return frames;
  }

  std::int64_t Seen() const {
    return std::count_if(frames_.begin(), frames_.end(), [](const Kept& kept) {
      return kept.state == State::kSeen;
    });
  }

  // Frames up to `last` that were not decoded will not be.
  void LeaveOutFrames(std::int64_t last) {
    for (; end_ < last; ++end_) {
      Kept& kept = KeptFrame(end_);
      if (kept.state != State::kUnknown) continue;
      kept.state = State::kLeftOut;
      kept.changes = {};
    }
  }

  // All is decoded. The still picture is made again of all samples: a body that
  // waits where the key frames show it would not have been seen, and then all
  // is decoded again.
  void Finish() {
    todo_.clear();
    next_ = 0;
    const std::set<std::int64_t> frames = std::move(grid_.frames);
    grid_ = {};
    for (const std::int64_t index : frames) CutDown(index);
    Background right = StillPicture();
    if (!IsRight(right)) {
      scout_.always.clear();
      still_ = std::move(right);
      DecodeAgain();
    }
  }

  void DecodeAgain() {
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      std::vector<KeptPixels> whole;
      if (whole_.contains(static_cast<std::int64_t>(i))) {
        whole = std::move(frames_[i].windows);
      }
      frames_[i] = {State::kUnknown, {}, std::move(whole)};
    }
    left_bytes_ = Room();
    DecodeAll();
  }

  // Decodes from end_ to `last`.
  void AdvanceDecoder(std::int64_t last) {
    const std::size_t end = CountEarlierFrames(last);
    Decode({todo_.begin() + static_cast<std::ptrdiff_t>(next_),
            todo_.begin() + static_cast<std::ptrdiff_t>(end)},
           todo_.size() - next_);
    next_ = end;
    LeaveOutFrames(last);
    done_ = end_ - options_.first;
  }

  // Decodes these frames, of `of` that share the room. Where frames are stored
  // alone, in parts whose number does not depend on the number of threads: the
  // same windows are kept with any number.
  void Decode(const std::vector<std::int64_t>& frames, std::size_t of) {
    if (frames.empty()) return;
    const Scout scout(*still_, scout_);
    const std::size_t room =
        left_bytes_ / std::max<std::size_t>(1, of) * frames.size();
    std::int64_t parts = 1;
    if (alone_) {
      parts = 16;  // enough for the cores of a workstation
      const auto readers =
          std::min<std::int64_t>(core::CountThreads(options_.threads), parts);
      while (static_cast<std::int64_t>(others_.size()) + 1 < readers) {
        auto other = clip_->OpenAnother();
        if (!other) break;
        others_.push_back(std::move(other));
      }
    }
    const auto begin_of = [&](std::int64_t part) {
      return frames.size() * static_cast<std::size_t>(part) /
             static_cast<std::size_t>(parts);
    };
    std::atomic<std::size_t> next = 0;
    core::InParallel(
        parts, static_cast<int>(others_.size()) + 1,
        [&](std::int64_t from, std::int64_t to) {
          const std::size_t mine = next++;
          Clip& clip = mine == 0 ? *clip_ : *others_[mine - 1];
          for (std::int64_t part = from; part < to; ++part) {
            DecodePart(clip, scout,
                       std::span(frames).subspan(
                           begin_of(part), begin_of(part + 1) - begin_of(part)),
                       room / static_cast<std::size_t>(parts));
          }
        });
  }

  void DecodePart(Clip& clip, const Scout& scout,
                  std::span<const std::int64_t> frames, std::size_t bytes) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const std::int64_t index = frames[i];
      Kept& kept = KeptFrame(index);
      const bool is_here =
          !kept.windows.empty() && kept.windows.front().Holds(Whole(info()));
      const core::Frame frame =
          is_here ? kept.windows.front().View() : clip.Read(index);
      kept.changes = scout.Look(frame);
      kept.state = State::kSeen;
      if (!is_here) {
        if (whole_.contains(index) || grid_.frames.contains(index)) {
          kept.windows.emplace_back(frame);
        } else {
          KeepWindows(frame, bytes, frames.size() - i, kept);
        }
      }
      const std::int64_t done = ++done_;
      if (options_.progress && &clip == clip_.get()) {
        options_.progress(static_cast<double>(done) /
                          static_cast<double>(options_.last - options_.first));
      }
    }
  }

  // Keeps the strongest window in any case, the others as far as each frame's
  // share of the part's bytes goes. Windows that are not kept are no changes.
  void KeepWindows(const core::Frame& frame, std::size_t& part_bytes,
                   std::size_t frames, Kept& kept) {
    std::size_t share = part_bytes / frames;
    std::vector<core::PixelRect>& where = kept.changes.where;
    std::vector<core::PixelRect> held;
    for (const core::PixelRect& rect : where) {
      const core::Frame window = CutWindow(frame, rect);
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

  // Takes bytes of the room that all parts share; false if there are not so
  // many.
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
  bool alone_ = false;                 // each frame can be read without others
  std::vector<std::int64_t> keys_;     // that still_ is made of at first
  std::vector<Changes> keys_changes_;  // from it
  std::vector<std::int64_t> todo_;     // to decode, piece by piece
  std::size_t next_ = 0;               // of todo_
  std::int64_t end_ = 0;               // [first, end_) is decoded, or left out
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
