// A body that is down from the start draws the contact line itself: the line
// where none is known, and what of its gaps is a known line's error.
#pragma once

#include <optional>

#include "touchdown/calib/plane.h"
#include "touchdown/vision/contact/plane_track.h"

namespace touchdown::vision {

// Where no edge is known to be the ground, but the body is on one all the time:
// the straight line along which its lowest point moves. That it is carried, and
// does not fly, its acceleration tells: free flight accelerates down the
// picture (within 15 degrees: a rolled camera), this along the path, and across
// it by less than a tenth of that or three times its uncertainty. u from the
// scatter across the path, of which a quarter of the frames counts
// (neighbouring outlines err alike), and from the body's size. Nothing where
// the track does not say so, or is shorter than the body.
std::optional<calib::GroundLine> GroundFromPath(const Track& track);

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
