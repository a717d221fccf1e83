#include "frame_spacing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace touchdown::vision {
namespace {

// Times that leave the even grid by less than this part of a frame period
// count as rounded by the container (1 ms ticks at 20 to 30 fps reach 1.5 %);
// cameras that vary their rate leave it by far more.
constexpr double kRoundingPeriods = 0.02;
// A gap is a whole number of periods to this part of one: half of it is what
// two frames may each have come early or late and still be told from the next.
constexpr double kGapPeriods = 0.25;
// More than that is no gap but a damaged time.
constexpr double kMostPeriods = 1e9;

// Frame i belongs at slots[i] periods after the first.
bool FitsGrid(const std::vector<double>& times_s,
              const std::vector<std::int64_t>& slots, double fps,
              double tick_s) {
  if (!(fps > 0.0) || !std::isfinite(fps)) return false;
  // A deviation of just one tick is not to be lost to binary fractions.
  constexpr double kSlack = 1.0 + 1e-6;
  const double allowed = std::max(tick_s * kSlack, kRoundingPeriods / fps);
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const double grid = static_cast<double>(slots[i]) / fps;
    if (std::abs(times_s[i] - times_s[0] - grid) > allowed) return false;
  }
  return true;
}

// The first of the rates that fits, else the times' own if that fits.
std::optional<double> RateOf(const std::vector<double>& times_s,
                             const std::vector<std::int64_t>& slots,
                             const std::vector<double>& stated_fps,
                             double tick_s) {
  for (const double fps : stated_fps) {
    if (FitsGrid(times_s, slots, fps, tick_s)) return fps;
  }
  const double own =
      static_cast<double>(slots.back()) / (times_s.back() - times_s.front());
  if (FitsGrid(times_s, slots, own, tick_s)) return own;
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

}  // namespace

FrameSpacing FindSpacing(const std::vector<double>& times_s,
                         const std::vector<double>& stated_fps, double tick_s) {
  FrameSpacing spacing;
  if (times_s.size() < 2) {
    for (const double fps : stated_fps) {
      if (fps > 0.0 && spacing.fps == 0.0) spacing.fps = fps;
    }
    return spacing;
  }
  std::vector<std::int64_t> slots(times_s.size());
  for (std::size_t i = 0; i < slots.size(); ++i) {
    slots[i] = static_cast<std::int64_t>(i);
  }
  if (const auto fps = RateOf(times_s, slots, stated_fps, tick_s)) {
    spacing.fps = *fps;
    return spacing;
  }

  if (times_s.back() <= times_s.front()) return spacing;
  spacing.uniform = false;
  const double period = MedianInterval(times_s);
  bool whole = period > 0.0;  // intervals are whole numbers of periods
  for (std::size_t i = 1; whole && i < times_s.size(); ++i) {
    const double interval = times_s[i] - times_s[i - 1];
    const double periods = std::max(1.0, std::round(interval / period));
    whole = periods <= kMostPeriods &&
            std::abs(interval / period - periods) <=
                std::max(kGapPeriods, 2.0 * tick_s / period);
    if (!whole) break;
    slots[i] = slots[i - 1] + static_cast<std::int64_t>(periods);
    if (periods > 1.0) {
      spacing.gaps.push_back({static_cast<std::int64_t>(i) - 1,
                              static_cast<std::int64_t>(periods) - 1});
    }
  }
  if (!whole) spacing.gaps.clear();
  const auto fps = whole ? RateOf(times_s, slots, stated_fps, tick_s)
                         : std::optional<double>();
  spacing.even = fps.has_value();
  spacing.fps = fps.value_or(static_cast<double>(times_s.size() - 1) /
                             (times_s.back() - times_s.front()));
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    spacing.times_s.push_back(fps ? static_cast<double>(slots[i]) / *fps
                                  : times_s[i] - times_s[0]);
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
