#include "contact/pixel_locking.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchdown::vision {
namespace {

// px^3; see the header.
constexpr double kAmplitude = 0.0087;
// px. No camera is sharper than half a pixel's own width.
constexpr double kLeastBlur_px = 0.4;
// Beyond its first maximum j1 is taken as its envelope, and sin(q) as 1: angles
// are not known well enough for its zeros.
constexpr double kFirstMaximum = 2.0816;
constexpr double kMaximum = 0.4362;

double PlaceFactor(double q) {
  return q < 0.5 * std::numbers::pi ? (q > 0.0 ? std::sin(q) / q : 1.0)
                                    : 1.0 / q;
}

double SlopeFactor(double q) {
  constexpr double kSmall = 1e-2;  // j1(q) = q / 3 to 1e-5 below
  if (q < kSmall) return q / 3.0;
  return q < kFirstMaximum ? std::sin(q) / (q * q) - std::cos(q) / q
                           : kMaximum * kFirstMaximum / q;
}

}  // namespace

PixelLocking EstimatePixelLocking(const PlaneTrack& track, double face_rad) {
  PixelLocking locking;
  if (track.kind == core::BodyKind::kSphere || !(track.blur_px > 0.0)) {
    return locking;
  }
  const double blur = std::max(track.blur_px, kLeastBlur_px);
  const double amplitude_px = kAmplitude / (blur * blur);
  // To the nearer of rows and columns; sin(2 alpha) / 2 is alpha near both.
  const double alpha =
      face_rad - track.direction * calib::ImageAngle(track.ground);
  const double h = track.half_long_px;
  const double q =
      2.0 * std::numbers::pi * h * std::abs(0.5 * std::sin(2.0 * alpha));
  // 1 / sqrt(2) of a sine's mean square, and of two edges.
  locking.place_px = 0.5 * amplitude_px * PlaceFactor(q);
  locking.face_rad = 0.5 * amplitude_px * 3.0 * SlopeFactor(q) / h;
  return locking;
}

}  // namespace touchdown::vision
