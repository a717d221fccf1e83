#include "outline_batch.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>

#include "kept_pixels.h"
#include "lanes.h"
#include "outline_pixels.h"
#include "read_apart.h"
#include "touchdown/core/parallel.h"

namespace touchdown::vision {
namespace {

// Windows that are held at once: a few MiB for bodies of any size.
constexpr std::size_t kBatch = 64;

struct Window {
  core::Frame frame;
  core::PixelRect first;  // what the fit looks at before it moves
  KeptPixels copy;        // where the clip's own view does not last
};

// Within the picture, so far to all sides of the outline's centre.
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

double HalfWay_px(const OutlineOptions& options) {
  return 0.5 * std::hypot(options.travel_px.x_px, options.travel_px.y_px);
}

// The outline and its blur where the fit begins (outline.cc).
core::PixelRect FirstSeen(const Outline& start, const OutlineOptions& options,
                          const ClipInfo& info) {
  constexpr double kBlurs = 3.0;
  constexpr double kSpare_px = 2.0;
  return WindowReaching(start.centre,
                        Extent(start) +
                            kBlurs * std::max(options.blur_px, 0.5) +
                            HalfWay_px(options) + kSpare_px,
                        info);
}

Window Take(Clip& clip, const OutlineJob& job, const OutlineOptions& options) {
  const core::PixelRect rect = WindowFor(job.start, options, clip.info());
  const std::int64_t index = job.frame;
  Window window;
  window.first = FirstSeen(job.start, options, clip.info());
  // Copied, all of it is read; else mostly nothing but this.
  clip.WillRead(index, clip.views_last() ? window.first : rect);
  window.frame = clip.Read(index, rect);
  if (!clip.views_last()) {
    window.copy = KeptPixels(window.frame);
    window.frame = window.copy.View();
  }
  return window;
}

void PrefetchRows(const Window& window) {
  const core::Frame frame = WindowOf(window.frame, window.first);
  const std::size_t bytes = RowBytes(frame);
  for (std::int32_t y = 0; y < frame.height_px; ++y) {
    Prefetch(frame.data + y * frame.stride_bytes, bytes);
  }
}

// The options of all, and a job's own.
OutlineOptions OptionsOfJob(const OutlineJob& job,
                            const OutlineOptions& options) {
  OutlineOptions own = options;
  own.travel_px = job.travel_px;
  own.turn_rad = job.turn_rad;
  return own;
}

// The fits of jobs [from, to) in their windows.
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

void TakeAll(Clip& clip, std::span<const OutlineJob> jobs,
             const OutlineOptions& options, std::vector<Window>& windows) {
  windows.clear();
  for (const OutlineJob& job : jobs) {
    windows.push_back(Take(clip, job, OptionsOfJob(job, options)));
  }
}

// Each thread reads what it fits, by a reader of its own.
void FitApart(Clip& clip, const Background& background,
              std::span<const OutlineJob> jobs, const OutlineOptions& options,
              int threads, std::vector<std::optional<Fitted>>& fits) {
  // Jobs: half a millisecond, or less where there are few.
  constexpr std::size_t kMostAtOnce = 8;
  constexpr std::size_t kTurns = 4;  // of each thread, at least
  const std::size_t at_once = std::clamp<std::size_t>(
      jobs.size() /
          (kTurns * static_cast<std::size_t>(core::ThreadsOf(threads))),
      1, kMostAtOnce);
  std::atomic<std::size_t> next = 0;
  core::InParallel(
      core::ThreadsOf(threads), threads, [&](std::int64_t, std::int64_t) {
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

core::PixelRect WindowFor(const Outline& start, const OutlineOptions& options,
                          const ClipInfo& info) {
  // The fit may move by a quarter of the size and double its blur, and looks
  // three blurs and half the way beyond the edge (outline.cc).
  constexpr double kMayMove = 0.5;
  constexpr double kBlurs = 6.0;
  constexpr double kSpare_px = 6.0;
  return WindowReaching(start.centre,
                        (1.0 + kMayMove) * Extent(start) +
                            kBlurs * std::max(options.blur_px, 0.5) +
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
