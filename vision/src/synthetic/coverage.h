// How much of each pixel a shape covers, blurred or not: the line integral of
// render.h around the shape's outline, in image coordinates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "touchdown/core/points.h"

namespace touchdown::vision {

// A closed outline made of straight and circular pieces.
struct OutlinePiece {
  bool is_arc = false;
  core::PixelPoint from;  // of a straight piece
  core::PixelPoint to;
  core::PixelPoint centre;  // of an arc from begin_rad to end_rad
  double radius_px = 0.0;
  double begin_rad = 0.0;
  double end_rad = 0.0;
};
struct ShapeOutline {
  std::vector<OutlinePiece> pieces;  // enclosing a positive integral of x dy
  bool full_circle = false;          // one arc, all around
};

ShapeOutline CircleOutline(core::PixelPoint centre, double radius_px);
// Corners in order, either way around.
ShapeOutline PolygonOutline(const std::vector<core::PixelPoint>& corners);

// Points p with normal . (p - point) < 0; `normal` is a unit vector.
struct HalfPlane {
  core::PixelPoint point;
  double normal_x = 0.0;
  double normal_y = -1.0;
};
std::vector<core::PixelPoint> ClipPolygon(
    const std::vector<core::PixelPoint>& corners, const HalfPlane& half);
ShapeOutline ClipCircle(core::PixelPoint centre, double radius_px,
                        const HalfPlane& half);

// Blur beyond which the kernel is cut: 5.2 sigma, where Phi is 1e-7.
inline constexpr double kKernelReach = 5.2;

// Coverage of the pixels of `window`. Add() any number of outlines, Finish()
// once, read.
class CoverageMap {
 public:
  CoverageMap(core::PixelRect window, double psf_sigma_px);

  void Add(const ShapeOutline& outline, double weight);
  void Finish();

  const core::PixelRect& window() const { return window_; }
  const double* row(std::int32_t y) const {  // of window column 0
    return sum_.data() + static_cast<std::size_t>(y - window_.y) *
                             static_cast<std::size_t>(window_.width);
  }

 private:
  void AddNode(double x, double y, double weighted_dy);
  void AddSmooth(const OutlinePiece& piece, bool periodic, double weight);
  void AddExact(const OutlinePiece& piece, double weight);
  double* mutable_row(std::int32_t y) {
    return sum_.data() + static_cast<std::size_t>(y - window_.y) *
                             static_cast<std::size_t>(window_.width);
  }

  core::PixelRect window_;
  double sigma_;
  std::vector<double> sum_;
};

}  // namespace touchdown::vision
