// A plane of travel that is turned from the picture's plane about its own
// vertical. Perspective then changes angles: to first order away from the axis,
// to second order on it. For a point at (X, Y) from the axis, Y upwards, in
// units of the focal length, a path that descends at the angle a is seen at
//   tan a_seen = (tan a + Y sin(yaw)) / (cos(yaw) - X sin(yaw))
// (reference/statistics.md 4.3; X, Y there are X/Z, Y/Z). Here it is undone
// point by point, so that the ground line, which is turned with the path, and
// speeds are right, too. With X = e.(p - axis), Y = n.(p - axis) in px along
// the plane's horizontal and up its vertical, k = sin(yaw) / focal:
//   right  = X / (cos(yaw) - k X) / d,   d: of the ground's reference point
//   height = Y D / d,                    D = 1 + k X / (cos(yaw) - k X)
// which are the coordinates in the plane, in px of its scale at the ground's
// reference point. The horizontal e is that for which the ground is level.
//
// Valid for |yaw| < 60 degrees and a level camera: a pitch p changes angles by
// a share of p yaw, which is left out.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "touchdown/calib/plane.h"
#include "touchdown/core/points.h"

namespace touchdown::vision {

struct PlaneYaw {
  // Positive where the plane's right end is farther away.
  double yaw_rad = 0.0;
  // Of the ideal picture. Infinite where no lens is known: then only what holds
  // on the axis is undone, the factor cos(yaw) along the ground.
  double focal_px = std::numeric_limits<double>::infinity();
  core::PixelPoint axis;  // where the camera's axis meets the ideal picture
};

// The ground line's plane, seen so.
struct YawedView {
  Eigen::Vector2d along;  // e and n, image coordinates
  Eigen::Vector2d up;     //
  core::PixelPoint axis;
  double cosine = 1.0;
  double k_per_px = 0.0;
  double reference_depth = 1.0;  // d
  double reference_px = 0.0;     // right and height of the ground's reference
  double ground_px = 0.0;        // point, from the axis
};

// Throws std::invalid_argument naming the field where |yaw| is not below 60
// degrees, the focal length not positive, or the reference point is where the
// plane's vanishing line is.
YawedView MakeYawedView(const calib::GroundLine& ground, const PlaneYaw& yaw);

struct InPlane {
  double right_px = 0.0;     // of the ground's reference point
  double height_px = 0.0;    // above the ground
  double depth = 1.0;        // over that of the reference point
  Eigen::Matrix2d jacobian;  // d(right, height) / d(image x, y)
};

InPlane ToPlane(const YawedView& view, core::PixelPoint image);
core::PixelPoint FromPlane(const YawedView& view, double right_px,
                           double height_px);

}  // namespace touchdown::vision
