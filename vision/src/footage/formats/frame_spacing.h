// What the times of a recording's frames say: equally spaced, equally spaced
// but for frames that are missing, or neither.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace touchdown::vision {

// Frames that are missing between two that are there.
struct FrameGap {
  std::int64_t after = 0;    // the frame before the gap
  std::int64_t missing = 0;  // how many would fit into it
};

struct FrameSpacing {
  // Rate of the frames that follow each other without a gap; the mean rate
  // where they keep no rate; 0: not known.
  double fps = 0.0;
  bool uniform = true;         // no gaps, and equally spaced
  bool even = true;            // equally spaced but for the gaps
  std::vector<FrameGap> gaps;  // ascending
  // Of each frame, from the first; empty if uniform. Of an even recording they
  // are whole numbers of periods, free of rounding.
  std::vector<double> times_s;
};

// How far the times of equally spaced frames may be off.
struct TimeErrors {
  // Times are whole numbers of ticks, rounded or cut off: no error where a
  // period is a whole number of them, too, else one tick.
  double tick_s = 0.0;
  double jitter_s = 0.0;  // of the clock
};

// `times_s` ascend; where some are alike no gaps are sought. Deviations from an
// even grid below 2 % of a period or below `errors` count as rounding. Of rates
// that agree with the times the first of `stated_fps` is taken (values that are
// not positive are left out); else what the times say themselves.
FrameSpacing FindSpacing(const std::vector<double>& times_s,
                         const std::vector<double>& stated_fps,
                         const TimeErrors& errors);

// One sentence for the user, without its end: "3 frames are missing (2 after
// frame 10, 1 after frame 40)" or "the file's frames are not equally spaced in
// time (mean 93 fps)"; empty if uniform.
std::string DescribeSpacing(const FrameSpacing& spacing);

}  // namespace touchdown::vision
