// The lens: where a point of the picture would be seen without distortion.
//
// Brown's model (D. C. Brown, "Decentering distortion of lenses", 1966; the
// form and the order of OpenCV). An ideal point (x, y) = ((X - cx) / f,
// (Y - cy) / f) with r^2 = x^2 + y^2 is seen at
//   x_d = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2)
//   y_d = y (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 y^2) + 2 p2 x y
//   X_d = fx x_d + cx,   Y_d = fy y_d + cy
// with f = sqrt(fx fy): the ideal picture has square pixels, and its centre and
// mean scale are those of the recorded one.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "touchdown/core/points.h"

namespace touchdown::calib {

struct Lens {
  double fx_px = 0.0;  // focal length over the pixel's width
  double fy_px = 0.0;  // and over its height
  double cx_px = 0.0;  // where the axis meets the picture
  double cy_px = 0.0;
  double k1 = 0.0;  // radial
  double k2 = 0.0;
  double p1 = 0.0;  // decentring
  double p2 = 0.0;
  double k3 = 0.0;  // radial

  friend bool operator==(const Lens&, const Lens&) = default;
};

// The lens as a vector, in the order fx fy cx cy k1 k2 p1 p2 k3: the order of
// every covariance of a lens.
inline constexpr int kLensParameters = 9;
inline constexpr std::array<const char*, kLensParameters> kLensNames = {
    "fx_px", "fy_px", "cx_px", "cy_px", "k1", "k2", "p1", "p2", "k3"};
using LensVector = Eigen::Matrix<double, kLensParameters, 1>;
using LensCovariance = Eigen::Matrix<double, kLensParameters, kLensParameters>;
LensVector ToVector(const Lens& lens);
Lens ToLens(const LensVector& vector);

// Focal length of the ideal picture, px.
double IdealFocal(const Lens& lens);

// Where an ideal point is seen.
core::PixelPoint Distort(const Lens& lens, core::PixelPoint ideal);

struct IdealPoint {
  core::PixelPoint point;
  Eigen::Matrix2d jacobian;  // d(ideal x, y) / d(image x, y)
};

// The inverse of Distort, by Newton's method, to 1e-10 px. Nothing where there
// is none: the model folds back beyond some radius (IsInvertible says whether
// that is in the picture).
std::optional<IdealPoint> Undistort(const Lens& lens, core::PixelPoint image);

// Whether every point of a picture of this size has an ideal point, the only
// one up to the picture's farthest corner.
bool IsInvertible(const Lens& lens, std::int32_t width_px,
                  std::int32_t height_px);

// The same lens for a picture whose pixel (0, 0) is the pixel (x, y) of this
// one: a cropped sensor.
Lens Cropped(const Lens& lens, double x_px, double y_px);

// Largest displacement |image - ideal| in a picture of this size, px.
double LargestDisplacement(const Lens& lens, std::int32_t width_px,
                           std::int32_t height_px);

}  // namespace touchdown::calib
