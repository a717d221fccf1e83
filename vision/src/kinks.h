// Instants at which a normal velocity jumps upward, the centre's or a block's
// lowest corner's: what a blow from the ground leaves in a track. Needs no
// ground line.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "touchdown/vision/plane_track.h"

namespace touchdown::vision {

struct Kink {
  std::size_t after = 0;      // the last sample before the jump
  double jump = 0.0;          // upward change of normal velocity, px/s
  double significance = 0.0;  // jump over its standard uncertainty
  double time_s = 0.0;        // where the two sides meet
  // Seen in the gap alone: of a block that turns it is no parabola, so that
  // only near the ground such a jump means a blow.
  bool of_gap = false;
};

struct KinkOptions {
  // Where gravity is known, px/s^2, both sides of a blow may be free flight.
  std::optional<double> gravity_px_per_s2;
  // Jumps less significant than this are noise: with a few hundred instants and
  // scales tried, 6 lets one false jump pass in 1e6 clips of normal noise.
  double least_significance = 6.0;

  // A jump must also move the body by this much within one frame interval or
  // within the window: slower ones are drift. In px.
  double least_effect_px = 0.05;
};

// All kinks by time, of the centre's height and, of a body that turns, of its
// gap. Windows of several lengths on both sides are tried: both sides in free
// flight where gravity is known, else with one curvature or, where frames
// allow, one of each. A blow must explain more than rest and more than one
// flight.
std::vector<Kink> FindKinks(std::span<const PlaneSample> samples,
                            const KinkOptions& options = {});

}  // namespace touchdown::vision
