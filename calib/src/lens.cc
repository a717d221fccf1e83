#include "touchdown/calib/lens.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace touchdown::calib {
namespace {

struct Normal {
  double x = 0.0;
  double y = 0.0;
};

// Brown's polynomial and its derivative, in units of the focal length.
Normal Bend(const Lens& lens, Normal at, Eigen::Matrix2d* derivative) {
  const double xx = at.x * at.x;
  const double yy = at.y * at.y;
  const double xy = at.x * at.y;
  const double r2 = xx + yy;
  const double radial = 1.0 + r2 * (lens.k1 + r2 * (lens.k2 + r2 * lens.k3));
  if (derivative != nullptr) {
    // d(radial) / d(r2)
    const double slope = lens.k1 + r2 * (2.0 * lens.k2 + r2 * 3.0 * lens.k3);
    const double cross =
        2.0 * slope * xy + 2.0 * lens.p1 * at.x + 2.0 * lens.p2 * at.y;
    *derivative << radial + 2.0 * slope * xx + 2.0 * lens.p1 * at.y +
                       6.0 * lens.p2 * at.x,
        cross, cross,
        radial + 2.0 * slope * yy + 6.0 * lens.p1 * at.y + 2.0 * lens.p2 * at.x;
  }
  return {at.x * radial + 2.0 * lens.p1 * xy + lens.p2 * (r2 + 2.0 * xx),
          at.y * radial + lens.p1 * (r2 + 2.0 * yy) + 2.0 * lens.p2 * xy};
}

// The picture's border and diagonals, in steps of a fiftieth.
template <class Visit>
void AlongBorder(std::int32_t width_px, std::int32_t height_px, Visit visit) {
  // Points on each side. Not studied.
  constexpr int kSteps = 50;
  const double w = width_px - 0.5;
  const double h = height_px - 0.5;
  for (int i = 0; i <= kSteps; ++i) {
    const double t = static_cast<double>(i) / kSteps;
    const double x = -0.5 + t * (w + 0.5);
    const double y = -0.5 + t * (h + 0.5);
    visit(core::PixelPoint{x, -0.5});
    visit(core::PixelPoint{x, h});
    visit(core::PixelPoint{-0.5, y});
    visit(core::PixelPoint{w, y});
  }
}

}  // namespace

LensVector ToVector(const Lens& lens) {
  LensVector v;
  v << lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px, lens.k1, lens.k2,
      lens.p1, lens.p2, lens.k3;
  return v;
}

Lens ToLens(const LensVector& v) {
  return {v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8]};
}

double IdealFocal(const Lens& lens) {
  return std::sqrt(lens.fx_px * lens.fy_px);
}

core::PixelPoint Distort(const Lens& lens, core::PixelPoint ideal) {
  const double f = IdealFocal(lens);
  const Normal bent =
      Bend(lens, {(ideal.x_px - lens.cx_px) / f, (ideal.y_px - lens.cy_px) / f},
           nullptr);
  return {lens.fx_px * bent.x + lens.cx_px, lens.fy_px * bent.y + lens.cy_px};
}

std::optional<IdealPoint> Undistort(const Lens& lens, core::PixelPoint image) {
  const double f = IdealFocal(lens);
  const Normal seen{(image.x_px - lens.cx_px) / lens.fx_px,
                    (image.y_px - lens.cy_px) / lens.fy_px};
  Normal at = seen;
  Eigen::Matrix2d derivative;
  // Newton's steps; a bound, since each doubles the digits.
  constexpr int kMaxSteps = 50;
  const double enough = 1e-11 / f;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Normal bent = Bend(lens, at, &derivative);
    // Beyond the radius at which the model folds back the determinant is no
    // longer positive: that branch is not the picture.
    const double determinant = derivative.determinant();
    if (!(determinant > 0.0) || !(derivative(0, 0) > 0.0)) return std::nullopt;
    const Eigen::Vector2d move =
        derivative.inverse() *
        Eigen::Vector2d(seen.x - bent.x, seen.y - bent.y);
    at.x += move.x();
    at.y += move.y();
    if (!(move.norm() < 1e6)) return std::nullopt;
    if (move.norm() < enough) break;
    if (step + 1 == kMaxSteps) return std::nullopt;
  }
  Bend(lens, at, &derivative);
  if (!(derivative.determinant() > 0.0)) return std::nullopt;
  IdealPoint ideal;
  ideal.point = {f * at.x + lens.cx_px, f * at.y + lens.cy_px};
  ideal.jacobian = f * derivative.inverse();
  ideal.jacobian.col(0) /= lens.fx_px;
  ideal.jacobian.col(1) /= lens.fy_px;
  return ideal;
}

bool IsInvertible(const Lens& lens, std::int32_t width_px,
                  std::int32_t height_px) {
  if (!(lens.fx_px > 0.0) || !(lens.fy_px > 0.0)) return false;
  bool all = true;
  AlongBorder(width_px, height_px, [&](core::PixelPoint p) {
    const auto ideal = Undistort(lens, p);
    if (!ideal) {
      all = false;
      return;
    }
    // No fold on the way from the axis to the border.
    const double f = IdealFocal(lens);
    // Places between axis and border. Not studied.
    constexpr int kSteps = 40;
    for (int i = 1; i <= kSteps; ++i) {
      const double t = static_cast<double>(i) / kSteps;
      Eigen::Matrix2d derivative;
      Bend(lens,
           {t * (ideal->point.x_px - lens.cx_px) / f,
            t * (ideal->point.y_px - lens.cy_px) / f},
           &derivative);
      all = all && derivative.determinant() > 0.0 && derivative(0, 0) > 0.0;
    }
  });
  return all;
}

Lens Cropped(const Lens& lens, double x_px, double y_px) {
  Lens out = lens;
  out.cx_px -= x_px;
  out.cy_px -= y_px;
  return out;
}

double LargestDisplacement(const Lens& lens, std::int32_t width_px,
                           std::int32_t height_px) {
  double most = 0.0;
  AlongBorder(width_px, height_px, [&](core::PixelPoint p) {
    const auto ideal = Undistort(lens, p);
    if (!ideal) return;
    most = std::max(most, std::hypot(ideal->point.x_px - p.x_px,
                                     ideal->point.y_px - p.y_px));
  });
  return most;
}

}  // namespace touchdown::calib
