// One smooth path through places found frame by frame.
//
// Of all choices of one candidate a frame that of least cost, by dynamic
// programming over pairs of candidates (a second-order Viterbi search):
//   cost = sum_t (1 - S_t) / s^2
//        + sum_t min(|p_t - 2 p_(t-1) + p_(t-2)|^2 / (2 a^2)
//                    + |p_t - p_(t-1)| / (50 a)
//                    + d(phi_t - phi_(t-1))^2 / (2 b^2),  most)
// d is taken to the nearest turn under which the shape looks the same. The
// bound `most` lets an impact, or one false frame, cost once and no more.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "detection/shape_search.h"

namespace touchdown::vision {

struct PathCosts {
  // a, in the candidates' unit: how far a place is off the parabola through its
  // neighbours by what cells and a turn of the flight leave. Smaller: true
  // places are skipped for their rounding; larger: ghosts beside them are
  // taken.
  double scatter = 1.0;

  // b: what a body turns between two frames. 0.25 rad (14 deg) is a body of 20
  // revolutions a second at 500 frames/s.
  double turn_rad = 0.25;

  // s^2: score that a path gives up for smoothness. 1/14 (the feasibility
  // study's, right on all its clips): a place that shows nothing costs as much
  // as one that is 5 scatters off.
  double score_variance = 1.0 / 14.0;

  // An impact's: 25 is five standard deviations squared, or that of 7 scatters.
  double most = 25.0;

  // SymmetryPeriod of the shape; 0: angles say nothing (a sphere).
  double period_rad = 0.0;
};

struct LinkedPath {
  std::vector<std::size_t> chosen;  // the candidate of each frame
  double cost = 0.0;                // of a frame, in the mean
};

// `frames` has candidates of frames of equal gaps, at least one of each; throws
// std::invalid_argument where a frame has none, or fewer than three frames.
LinkedPath LinkPath(std::span<const std::vector<PlacedShape>> frames,
                    const PathCosts& costs);

}  // namespace touchdown::vision
