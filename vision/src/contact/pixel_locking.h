// What straight edges beside the pixels' rows or columns are off by, with their
// place between two pixels ("pixel locking": M. Raffel et al., Particle Image
// Velocimetry, section 6.1).
//
// Pictures that were resampled have it, as a colour pattern, scaling and
// stabilisation do: linear interpolation draws the edge z = (x - x0) / s of
// blur s by  d(x0) = a sin(2 pi x0),  a = 0.0087 px^3 / s^2  (least squares of
// Phi(z) on a box of one pixel that was blurred afterwards; s from 0.6 to 1.5
// px, within 5 %). An edge that is inclined to the rows averages over its
// phases. For one of half length h at the angle alpha, q = 2 pi h sin(alpha),
// over all x0:
//   rms of the place  a / sqrt(2) |sin q| / q
//   rms of the slope  a / sqrt(2) 3 |j1(q)| / h,   j1 = sin q / q^2 - cos q / q
// A rectangle has two such edges, whose phases have nothing to do with each
// other.
#pragma once

#include "touchdown/vision/contact/plane_track.h"

namespace touchdown::vision {

struct PixelLocking {
  double place_px = 0.0;  // across the long side
  double face_rad = 0.0;
};

// Standard uncertainties of a rectangle at `face_rad`; zero for a sphere, whose
// outline has all phases, and where the blur is not known.
PixelLocking EstimatePixelLocking(const PlaneTrack& track, double face_rad);

}  // namespace touchdown::vision
