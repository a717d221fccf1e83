#include "touchdown/vision/contact/plane_yaw.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "touchdown/core/units.h"

namespace touchdown::vision {
namespace {

// Image coordinates from the optical axis, along the level direction and up.
Eigen::Vector2d FromAxis(const YawedView& view, core::PixelPoint p) {
  const Eigen::Vector2d off(p.x_px - view.axis.x_px, p.y_px - view.axis.y_px);
  return {view.along.dot(off), view.up.dot(off)};
}

}  // namespace

YawedView MakeYawedView(const calib::GroundLine& ground, const PlaneYaw& yaw) {
  // Beyond it the plane is seen at half of its length or less; a camera stands
  // so only by mistake. Not studied.
  constexpr double kMaxYaw_rad = 60.0 * core::kDegree;
  if (!(std::abs(yaw.yaw_rad) < kMaxYaw_rad)) {
    throw std::invalid_argument(fmt::format(
        "yaw is {:g} deg, must be within 60", yaw.yaw_rad / core::kDegree));
  }
  if (!(yaw.focal_px > 0.0)) {
    throw std::invalid_argument(
        fmt::format("focal_px is {}, must be positive", yaw.focal_px));
  }
  YawedView view;
  const bool perspective = std::isfinite(yaw.focal_px);
  // Without a focal length nothing depends on the axis.
  view.axis = perspective ? yaw.axis : ground.reference;
  view.cosine = std::cos(yaw.yaw_rad);
  view.k_per_px = perspective ? std::sin(yaw.yaw_rad) / yaw.focal_px : 0.0;
  const double seen_rad = calib::ImageAngle(ground);
  double angle_rad = seen_rad;
  // A level line of the plane, Y D = const, is seen inclined by atan(k Y D /
  // cos(yaw)); each step gains the digits of k Y.
  // A bound only: the loop ends when the angle stays the same.
  constexpr int kMaxSteps = 40;
  for (int step = 0; step < kMaxSteps; ++step) {
    view.along = {std::cos(angle_rad), std::sin(angle_rad)};
    view.up = {std::sin(angle_rad), -std::cos(angle_rad)};
    const Eigen::Vector2d at = FromAxis(view, ground.reference);
    const double towards = view.cosine - view.k_per_px * at.x();
    if (!(towards > 0.0)) {
      throw std::invalid_argument(
          "ground has its reference point beyond the vanishing line of a plane "
          "with this yaw");
    }
    view.reference_depth = view.cosine / towards;
    view.reference_px = at.x() / towards;
    view.ground_px = at.y() * view.reference_depth;
    const double next =
        seen_rad - std::atan(view.k_per_px * view.ground_px / view.cosine);
    if (next == angle_rad) break;
    angle_rad = next;
  }
  return view;
}

// Projective map of a plane turned by the yaw about the vertical: with c =
// cos(yaw), k = sin(yaw)/f and image coordinates (x, y) from the axis, X = x /
// (c - k x), depth D = c / (c - k x), Y = y D. Distances are divided by the
// depth at the reference point, where one px of the plane is one px.
InPlane ToPlane(const YawedView& view, core::PixelPoint image) {
  const Eigen::Vector2d p = FromAxis(view, image);
  const double towards = view.cosine - view.k_per_px * p.x();
  const double right = p.x() / towards;
  const double depth = view.cosine / towards;
  const double d = view.reference_depth;
  InPlane out;
  out.right_px = (right - view.reference_px) / d;
  out.height_px = (p.y() * depth - view.ground_px) / d;
  out.depth = depth / d;
  // dX/dx = c / (c - k x)^2; dY/dx = y k times the same.
  const double stretch = view.cosine / (towards * towards);
  Eigen::Matrix2d to_axis;
  to_axis.row(0) = view.along;
  to_axis.row(1) = view.up;
  Eigen::Matrix2d j;
  j << stretch, 0.0, p.y() * view.k_per_px * stretch, depth;
  out.jacobian = j * to_axis / d;
  return out;
}

// The inverse of ToPlane: x = X c / (1 + k X), y = Y / (1 + k X).
core::PixelPoint FromPlane(const YawedView& view, double right_px,
                           double height_px) {
  const double d = view.reference_depth;
  const double right = right_px * d + view.reference_px;
  const double depth = 1.0 + view.k_per_px * right;
  const double x = right * view.cosine / depth;
  const double y = (height_px * d + view.ground_px) / depth;
  const Eigen::Vector2d p = x * view.along + y * view.up;
  return {view.axis.x_px + p.x(), view.axis.y_px + p.y()};
}

}  // namespace touchdown::vision
