// The body's path, cut into stretches of one motion each.
#pragma once

#include <cstdint>

namespace touchdown::vision {

enum class StretchKind {
  kFlight,     // along and face linear in time, height a parabola
  kSupported,  // the lowest point on the ground line; slides, rolls or rests
  kContact,    // between touchdown and release of a body that takes its time
  kOther,      // carried by a hand or a ramp before its first flight, caught or
               // stopped by something else after its last
};

struct PathStretch {
  StretchKind kind = StretchKind::kOther;
  std::int64_t first_frame = 0;  // [first, last]
  std::int64_t last_frame = 0;
  // Of the poses about the stretch, by their u as widened to their scatter;
  // about 1 or less where the stretch describes them.
  double chi2 = 0.0;
  int degrees = 0;  // of freedom
};

}  // namespace touchdown::vision
