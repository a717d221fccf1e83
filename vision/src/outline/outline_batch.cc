#include "outline/outline_batch.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>

#include "footage/kept_pixels.h"
#include "footage/read_apart.h"
#include "numbers/lanes.h"
#include "outline/outline_pixels.h"
#include "touchdown/core/parallel.h"

namespace touchdown::vision {
namespace {

// Windows in memory at once: a few MiB for bodies of any size. Not studied.
constexpr std::size_t kBatch = 64;

// The part of a frame that one fit reads.
struct Window {
  core::Frame frame;
  core::PixelRect first;  // what the fit looks at before it moves
  KeptPixels copy;        // where the clip's own view does not last
};

// The square of half width `reach_px` about a centre, clipped to the picture.
core::PixelRect WindowReaching(const core::PixelPoint& centre, double reach_px,
                               const ClipInfo& info) {
  const auto from = [&](double at, std::int32_t end) {
    return static_cast<std::int32_t>(
        std::clamp(std::floor(at - reach_px), 0.0, end - 1.0));
  };
  const auto to = [&](double at, std::int32_t end) {
    return static_cast<std::int32_t>(
        std::clamp(std::ceil(at + reach_px), 0.0, end - 1.0));
  };
  core::PixelRect rect;
  rect.x = from(centre.x_px, info.width_px);
  rect.y = from(centre.y_px, info.height_px);
  rect.width = to(centre.x_px, info.width_px) - rect.x + 1;
  rect.height = to(centre.y_px, info.height_px) - rect.y + 1;
  return rect;
}

// Half of the way that the body goes in a frame interval: it smears the edge so
// far to either side.
double HalfWay_px(const OutlineOptions& options) {
  return 0.5 * std::hypot(options.travel_px.x_px, options.travel_px.y_px);
}

// What the fit reads in its first round: the outline, its blur and its motion
// (the band of outline.cc).
core::PixelRect FirstSeen(const Outline& start, const OutlineOptions& options,
                          const ClipInfo& info) {
  // As the band of outline.cc (kBandBlurs), and its rounding. A wrong value
  // costs time only: this is what is fetched ahead.
  constexpr double kFirstBlurs = 3.0;
  constexpr double kFirstSpare_px = 2.0;
  return WindowReaching(start.centre,
                        Extent(start) +
                            kFirstBlurs * std::max(options.blur_px, 0.5) +
                            HalfWay_px(options) + kFirstSpare_px,
                        info);
}

Window Take(Clip& clip, const OutlineJob& job, const OutlineOptions& options) {
  const core::PixelRect rect = ChooseWindow(job.start, options, clip.info());
  const std::int64_t index = job.frame;
  Window window;
  window.first = FirstSeen(job.start, options, clip.info());
  // A window that must be copied is read whole; of a lasting view mostly this
  // part alone is touched.
  clip.WillRead(index, clip.views_last() ? window.first : rect);
  window.frame = clip.Read(index, rect);
  if (!clip.views_last()) {
    window.copy = KeptPixels(window.frame);
    window.frame = window.copy.View();
  }
  return window;
}

// Asks for the next window's rows while this one is fitted.
void PrefetchRows(const Window& window) {
  const core::Frame frame = CutWindow(window.frame, window.first);
  const std::size_t bytes = RowBytes(frame);
  for (std::int32_t y = 0; y < frame.height_px; ++y) {
    Prefetch(frame.data + y * frame.stride_bytes, bytes);
  }
}

// The common options with the motion of one job.
OutlineOptions OptionsOfJob(const OutlineJob& job,
                            const OutlineOptions& options) {
  OutlineOptions own = options;
  own.travel_px = job.travel_px;
  own.turn_rad = job.turn_rad;
  return own;
}

// Fits jobs [from, to) in their windows.
void FitThese(std::span<const OutlineJob> jobs, std::span<const Window> windows,
              const Background& background, const OutlineOptions& options,
              const core::Cancellation& until, std::size_t from, std::size_t to,
              std::optional<Fitted>* fits) {
  for (std::size_t i = from; i < to; ++i) {
    until.Check(jobs[i].frame);
    if (i + 1 < to) PrefetchRows(windows[i + 1]);
    const core::Frame& frame = windows[i].frame;
    const auto fit = FitOutline(frame, background, jobs[i].start,
                                OptionsOfJob(jobs[i], options));
    if (fit) fits[i] = Fitted{jobs[i].frame, frame.time_s, *fit};
  }
}

// Reads the windows of all jobs, in the jobs' order.
void TakeAll(Clip& clip, std::span<const OutlineJob> jobs,
             const OutlineOptions& options, std::vector<Window>& windows) {
  windows.clear();
  for (const OutlineJob& job : jobs) {
    windows.push_back(Take(clip, job, OptionsOfJob(job, options)));
  }
}

// Each thread reads what it fits by a reader of its own, so that unpacking is
// parallel, too.
void FitApart(Clip& clip, const Background& background,
              std::span<const OutlineJob> jobs, const OutlineOptions& options,
              int threads, std::vector<std::optional<Fitted>>& fits) {
  // Jobs that a thread takes at once, about half a millisecond. More leave
  // threads idle at the end; fewer cost turns at the counter. Not studied.
  constexpr std::size_t kMaxAtOnce = 8;
  // Turns that each thread has at least.
  constexpr std::size_t kMinTurns = 4;
  const std::size_t at_once = std::clamp<std::size_t>(
      jobs.size() /
          (kMinTurns * static_cast<std::size_t>(core::CountThreads(threads))),
      1, kMaxAtOnce);
  std::atomic<std::size_t> next = 0;
  core::InParallel(
      core::CountThreads(threads), threads, [&](std::int64_t, std::int64_t) {
        const std::unique_ptr<Clip> own = clip.OpenAnother();
        std::vector<Window> windows;
        for (std::size_t begin = next.fetch_add(at_once); begin < jobs.size();
             begin = next.fetch_add(at_once)) {
          const auto some =
              jobs.subspan(begin, std::min(at_once, jobs.size() - begin));
          TakeAll(*own, some, options, windows);
          FitThese(some, windows, background, options, own->cancellation(), 0,
                   some.size(), &fits[begin]);
        }
      });
}

}  // namespace

core::PixelRect ChooseWindow(const Outline& start,
                             const OutlineOptions& options,
                             const ClipInfo& info) {
  // Of the extent: the fit may move by a quarter of the size and double its
  // blur, and looks three blurs and half the way beyond the edge (outline.cc).
  // A larger window costs memory; a smaller one ends fits at its border.
  constexpr double kMayMove = 0.5;
  // Twice kBandBlurs, since the blur may double.
  constexpr double kWindowBlurs = 6.0;
  constexpr double kSpare_px = 6.0;
  return WindowReaching(start.centre,
                        (1.0 + kMayMove) * Extent(start) +
                            kWindowBlurs * std::max(options.blur_px, 0.5) +
                            HalfWay_px(options) + kSpare_px,
                        info);
}

std::vector<std::optional<Fitted>> FitOutlines(Clip& clip,
                                               const Background& background,
                                               std::span<const OutlineJob> jobs,
                                               const OutlineOptions& options,
                                               int threads) {
  std::vector<std::optional<Fitted>> fits(jobs.size());
  if (CanReadApart(clip)) {
    FitApart(clip, background, jobs, options, threads, fits);
    return fits;
  }
  std::vector<Window> windows;
  for (std::size_t begin = 0; begin < jobs.size(); begin += kBatch) {
    const std::span<const OutlineJob> batch =
        jobs.subspan(begin, std::min(kBatch, jobs.size() - begin));
    TakeAll(clip, batch, options, windows);
    core::InParallel(static_cast<std::int64_t>(batch.size()), threads,
                     [&](std::int64_t from, std::int64_t to) {
                       FitThese(batch, windows, background, options,
                                clip.cancellation(),
                                static_cast<std::size_t>(from),
                                static_cast<std::size_t>(to), &fits[begin]);
                     });
  }
  return fits;
}

std::vector<Fitted> Found(const std::vector<std::optional<Fitted>>& fits) {
  std::vector<Fitted> found;
  for (const auto& fit : fits) {
    if (fit) found.push_back(*fit);
  }
  return found;
}

}  // namespace touchdown::vision
