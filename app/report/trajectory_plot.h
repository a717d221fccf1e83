// The paths of a group's bodies in one plot, aligned at touchdown.
#pragma once

#include <string>
#include <vector>

#include "app/report/contact_strip.h"
#include "touchdown/core/words.h"

namespace touchdown::report {

struct TrajectoryLine {
  const Trajectory* path = nullptr;
  core::MotionState state = core::MotionState::kUndecided;
};

struct TrajectoryPlot {
  std::vector<TrajectoryLine> lines;
  double reach_m = 0.1;  // shown on either side of touchdown, at most
  bool simulated = false;
  std::string id;  // as in BoundaryPlot
};

// The gap over the way along the ground, in mm, as an SVG element. The same
// input gives the same bytes. Throws like RunGnuplot().
std::string DrawTrajectoryPlot(const TrajectoryPlot& plot);

}  // namespace touchdown::report
