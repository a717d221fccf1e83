// The Cramer-Rao bound of the whole chain: what the pixels of one clip can tell
// of its angles and its contact time, however they are read.
//
// Pixels. An edge of contrast C, blurred by a total b px, in noise of standard
// deviation s gives J = C^2 / (2 sqrt(pi) b s^2) per px of its length on its
// normal displacement (b^2 = lens^2 + 1/12 + (n.e)^2 l^2/12 with the motion l e
// in one exposure; s^2 with 1/12 DN^2 of rounding). A pose's information is the
// integral of J p p' around the outline, p the normal displacement per unit of
// (x, y, angle, half sides or radius); next to corners b px carry none, nor
// does what an obstacle hides. Ground. The edge between background and ground,
// in the mean of all frames, over the whole width; with texture (a Gaussian
// field on the ground's side, correlated) by generalised least squares on a
// strip of it. Trajectory. Parameters: contact time and place, velocities
// before and after, the body's size, the ground's height and angle, for a
// rectangle its angle and its two angular velocities. The centre's path is
// continuous at contact and its height there is that of the body on the ground.
// What `analyze` is told beside the pixels counts as told: the scale, and
// standard gravity. Where the body's face has a picture, that and the still
// picture are unknown (face_information.h).
#pragma once

#include "tests/accuracy/design.h"

namespace touchdown::accuracy {

// Standard deviations; NaN where the quantity does not exist, or the pixels do
// not tell it.
struct Bound {
  double approach_rad = 0.0;
  double frame = 0.0;  // contact time, in frames
  double face_rad = 0.0;
  double radius_rad = 0.0;
  double centre_px = 0.0;  // of one frame, along the ground, for information
};

Bound BoundOf(const Case& c);

}  // namespace touchdown::accuracy
