// A body that is down from the start draws the contact line itself: what of its
// gaps is the line's error and not the body's.
#pragma once

#include "touchdown/core/units.h"
#include "touchdown/vision/plane_track.h"

namespace touchdown::vision {

// An edge of the ground seen in perspective differs from the contact line by so
// much; more is another line, or none.
inline constexpr double kMostInclined_rad = 1.0 * core::kDegree;

// What carries a body leaves of its fall so much beside the acceleration along
// the ground, at most.
inline constexpr double kCarried = 0.1;

struct PathTrend {
  // Of the gaps along the ground: the visible edge's error where it is small.
  double slope_rad = 0.0;
  // From the middle of the path to the straight line between its ends, up; what
  // a lens without calibration bends. 0: not asked for.
  double bend_px = 0.0;
};

// Takes the trend out of gaps and heights. The slope by a robust straight line
// through all samples. The bend only where the line is one that was found, in
// the picture or from the path, which is straight though the lens need not be;
// where Schwarz's criterion asks for it (n ln(rss/n) + k ln n; Annals of
// Statistics 6, 1978), where it is of a lens's size, and where what carries the
// body shows: a flight bends by its own fall, which is no small part of the
// acceleration along the ground.
PathTrend TakeOutTrend(PlaneTrack& track);

}  // namespace touchdown::vision
