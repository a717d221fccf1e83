// The noise of a track, judged by its own scatter.
#pragma once

#include "touchdown/vision/plane_track.h"

namespace touchdown::vision {

// Where third differences, blind to any parabola, exceed what the poses claim,
// the claims are widened.
void WidenToScatter(PlaneTrack& track);

}  // namespace touchdown::vision
