// A track as a lens without distortion would have shown it. Points are
// undistorted, never pictures: pixels keep their noise and their edges.
#pragma once

#include "touchdown/calib/lens.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::vision {

// The track in the lens's ideal picture (calib/lens.h). In each frame the
// ideal outline is found whose distorted image, fitted with the outline that
// the tracker fits (circle; rectangle), gives the pose that was measured: its
// centre is not that of the image's outline, because distortion bends it. The
// covariance of the centre and the uncertainty of the angle follow through the
// Jacobian; the size is undone frame by frame, so that a body that seemed to
// grow towards the picture's middle no longer does.
//
// Poses where the lens has no ideal point are left out, with a warning. The
// uncertainty of the lens itself is not in the result: it is common to all
// frames (app/measure/lens_uncertainty.h).
Track Undistorted(const Track& track, const calib::Lens& lens);

}  // namespace touchdown::vision
