#include "footage/formats/frame_spacing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace touchdown::vision {
namespace {

// Frame periods. Times that leave the even grid by less count as rounded by the
// container (1 ms ticks at 20 to 30 fps reach 1.5 %); cameras that vary their
// rate leave it by far more.
constexpr double kRoundingPeriods = 0.02;
// Frame periods. A gap is a whole number of periods to this: half of it is what
// two frames may each have come early or late and still be told from the next.
constexpr double kGapPeriods = 0.25;
// Frame periods: more is no gap but a damaged time.
constexpr double kMaxPeriods = 1e9;

// Whether `last` periods stay on whole numbers of ticks.
bool TicksAreExact(double period_s, std::int64_t last,
                   const TimeErrors& errors) {
  if (!(errors.tick_s > 0.0)) return true;
  const double ticks = period_s / errors.tick_s;
  const double drift =
      std::abs(ticks - std::round(ticks)) * static_cast<double>(last);
  // Of a tick: so much drift over the clip rounds no time to another tick.
  constexpr double kMaxDrift = 0.01;
  return std::round(ticks) >= 1.0 && drift < kMaxDrift;
}

// What the clock's resolution and jitter may put a time off by.
double AllowedS(double period_s, std::int64_t last, const TimeErrors& errors) {
  if (TicksAreExact(period_s, last, errors)) return errors.jitter_s;
  // A deviation of just one tick is not to be lost to binary fractions.
  constexpr double kSlack = 1.0 + 1e-6;
  return std::max(errors.tick_s * kSlack, errors.jitter_s);
}

// Frame i belongs at slots[i] periods after the first.
bool FitsGrid(const std::vector<double>& times_s,
              const std::vector<std::int64_t>& slots, double fps,
              const TimeErrors& errors) {
  if (!(fps > 0.0) || !std::isfinite(fps)) return false;
  const double allowed = std::max(AllowedS(1.0 / fps, slots.back(), errors),
                                  kRoundingPeriods / fps);
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const double grid = static_cast<double>(slots[i]) / fps;
    if (std::abs(times_s[i] - times_s[0] - grid) > allowed) return false;
  }
  return true;
}

// The first of the rates that fits, else the times' own if that fits.
std::optional<double> ChooseRate(const std::vector<double>& times_s,
                                 const std::vector<std::int64_t>& slots,
                                 const std::vector<double>& stated_fps,
                                 const TimeErrors& errors) {
  for (const double fps : stated_fps) {
    if (FitsGrid(times_s, slots, fps, errors)) return fps;
  }
  const double own =
      static_cast<double>(slots.back()) / (times_s.back() - times_s.front());
  if (FitsGrid(times_s, slots, own, errors)) return own;
  return std::nullopt;
}

double MedianInterval(const std::vector<double>& times_s) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    intervals.push_back(times_s[i] - times_s[i - 1]);
  }
  // The lower one of an even number: a gap is no period.
  const auto middle = intervals.begin() +
                      static_cast<std::ptrdiff_t>((intervals.size() - 1) / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

// How many periods after the first each frame comes; nothing where intervals
// are no whole numbers of periods.
std::optional<std::vector<std::int64_t>> FindSlots(
    const std::vector<double>& times_s, double period,
    const TimeErrors& errors) {
  if (!(period > 0.0)) return std::nullopt;
  const auto last = static_cast<std::int64_t>(times_s.size()) - 1;
  const double allowed =
      std::max(kGapPeriods, 2.0 * AllowedS(period, last, errors) / period);
  std::vector<std::int64_t> slots = {0};
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    const double interval = (times_s[i] - times_s[i - 1]) / period;
    const double periods = std::max(1.0, std::round(interval));
    if (periods > kMaxPeriods || std::abs(interval - periods) > allowed) {
      return std::nullopt;
    }
    slots.push_back(slots.back() + static_cast<std::int64_t>(periods));
  }
  return slots;
}

// Of frames that follow each other at `fps`, but for gaps.
FrameSpacing WithGaps(const std::vector<std::int64_t>& slots, double fps) {
  FrameSpacing spacing;
  spacing.fps = fps;
  spacing.uniform = false;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    spacing.times_s.push_back(static_cast<double>(slots[i]) / fps);
    const std::int64_t step = i > 0 ? slots[i] - slots[i - 1] : 1;
    if (step > 1) {
      spacing.gaps.push_back({static_cast<std::int64_t>(i) - 1, step - 1});
    }
  }
  return spacing;
}

}  // namespace

FrameSpacing FindSpacing(const std::vector<double>& times_s,
                         const std::vector<double>& stated_fps,
                         const TimeErrors& errors) {
  FrameSpacing spacing;
  const auto stated = std::find_if(stated_fps.begin(), stated_fps.end(),
                                   [](double fps) { return fps > 0.0; });
  if (times_s.size() < 2) {
    if (stated != stated_fps.end()) spacing.fps = *stated;
    return spacing;
  }
  std::vector<std::int64_t> slots(times_s.size());
  std::iota(slots.begin(), slots.end(), std::int64_t{0});
  for (const double fps : stated_fps) {
    if (!FitsGrid(times_s, slots, fps, errors)) continue;
    spacing.fps = fps;
    return spacing;
  }
  if (times_s.back() <= times_s.front()) return spacing;

  // Where a tick is a period, a frame that is missing looks like rounding of a
  // slower rate: there the rate that the file states decides.
  const double median = MedianInterval(times_s);
  if (stated != stated_fps.end() &&
      std::abs(median * *stated - 1.0) <= kGapPeriods) {
    const auto gaps = FindSlots(times_s, 1.0 / *stated, errors);
    if (gaps && TicksAreExact(1.0 / *stated, gaps->back(), errors) &&
        FitsGrid(times_s, *gaps, *stated, errors)) {
      return WithGaps(*gaps, *stated);
    }
  }
  if (const auto fps = ChooseRate(times_s, slots, {}, errors)) {
    spacing.fps = *fps;
    return spacing;
  }
  const auto gaps = FindSlots(times_s, median, errors);
  if (gaps) {
    if (const auto fps = ChooseRate(times_s, *gaps, stated_fps, errors)) {
      return WithGaps(*gaps, *fps);
    }
    spacing = WithGaps(*gaps, 1.0);
  }
  spacing.uniform = false;
  spacing.even = false;
  spacing.fps = static_cast<double>(times_s.size() - 1) /
                (times_s.back() - times_s.front());
  spacing.times_s.clear();
  for (const double time : times_s) {
    spacing.times_s.push_back(time - times_s[0]);
  }
  return spacing;
}

std::string DescribeSpacing(const FrameSpacing& spacing) {
  if (spacing.uniform) return "";
  std::string text;
  if (!spacing.even) {
    text = fmt::format(
        "the file's frames are not equally spaced in time (mean {:.6g} fps)",
        spacing.fps);
  }
  if (spacing.gaps.empty()) return text;
  // Gaps that the warning names; the others are counted.
  constexpr std::size_t kShown = 3;
  std::int64_t missing = 0;
  std::string where;
  for (std::size_t i = 0; i < spacing.gaps.size(); ++i) {
    const FrameGap& gap = spacing.gaps[i];
    missing += gap.missing;
    if (i < kShown) {
      where += fmt::format("{}{} after frame {}", i > 0 ? ", " : "",
                           gap.missing, gap.after);
    }
  }
  if (spacing.gaps.size() > kShown) {
    where += fmt::format(", at {} more places", spacing.gaps.size() - kShown);
  }
  return fmt::format(
      "{}{}{} missing, dropped when they were recorded or "
      "saved ({})",
      text, text.empty() ? "" : "; ",
      missing == 1 ? "1 frame is" : fmt::format("{} frames are", missing),
      where);
}

}  // namespace touchdown::vision
