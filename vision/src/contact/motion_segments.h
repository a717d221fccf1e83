// Cuts a plane track into stretches of one motion each: optimal partitioning
// (Jackson et al., IEEE Signal Process. Lett. 12, 2005, 105) under Schwarz's
// criterion, with the inequality pruning of Killick et al. (J. Am. Stat. Assoc.
// 107, 2012, 1590).
//
//   minimise  sum over stretches of  RSS/2 + (k/2) ln N + end terms
//             + ln n for each cut
//
// RSS: squared residuals over u; k: parameters of the stretch; N: measured
// numbers; n: frames. A flight is a parabola with constant spin; where gravity
// is known its curvature is no parameter. The end terms say that flights begin
// and end on the ground: the gap of the flight vanishes between its last frame
// and the next.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "touchdown/core/units.h"
#include "touchdown/vision/contact/path.h"
#include "touchdown/vision/contact/plane_track.h"

namespace touchdown::vision {

struct Stretch : SampleRange {
  StretchKind kind = StretchKind::kOther;
  double chi2 = 0.0;  // of its poses about it
  int degrees = 0;    // of freedom
};

// rad: by how much an edge of the ground seen in perspective may differ in
// direction from the line of contact. With more, a slow descent or a turn
// passes for rest; with less, rest along a line that is off is cut into
// flights. Not studied.
inline constexpr double kMaxEdgeTilt_rad = 0.5 * core::kDegree;

struct SegmentationOptions {
  // Along the ground's normal, px/s^2; nothing: one more parameter a flight.
  std::optional<double> gravity_px_per_s2;

  // A person says so: the first sample after touchdown. Nothing touches before
  // it, and a flight ends there.
  std::optional<std::size_t> touchdown;

  // Added to the poses' own u in quadrature, for the choice of stretches only:
  // a common error of outline and ground's edge, up to 0.07 px, must not pass
  // for an impact. 0.02: the least that keeps impacts a frame apart whole.
  double floor_px = 0.02;

  // How far outlines beside the ground's edge may be off together: part of the
  // line's u. 0.1: the most that was seen in clips of known truth; with less a
  // line that is off by 0.2 px makes contacts of impacts.
  double edge_bias_px = 0.1;

  // In units of ln odds: what a flight's end or start costs at most that lies
  // far from the line, and what a stretch costs whose motion is none of those
  // known. An impact off the line, which has an end and a start, must be the
  // cheaper: it refutes the line, a stretch of any motion hides it.
  double off_line_cost = 30.0;
  double unknown_cost = 70.0;

  // A rebound must be so much likelier than rest; else the noise of a body at
  // rest is taken for small hops. 8: odds of 3000 to 1.
  double rebound_cost = 8.0;
};

struct Segmentation {
  // They follow each other without a gap and cover all samples.
  std::vector<Stretch> stretches;
  double cost = 0.0;  // what was minimised, in units of ln odds
};

// Throws nothing; an empty track has no stretches.
Segmentation SegmentMotion(const PlaneTrack& track,
                           const SegmentationOptions& options = {});

}  // namespace touchdown::vision
