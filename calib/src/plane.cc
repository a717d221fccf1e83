#include "touchdown/calib/plane.h"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace touchdown::calib {

std::string_view Name(GroundSource source) {
  switch (source) {
    case GroundSource::kCalibration:
      return "calibration";
    case GroundSource::kUser:
      return "user";
    case GroundSource::kDetected:
      return "detected";
    case GroundSource::kContactPoints:
      return "contact-points";
  }
  return "?";
}

std::string_view Name(ScaleSource source) {
  switch (source) {
    case ScaleSource::kCalibration:
      return "calibration";
    case ScaleSource::kUser:
      return "user";
    case ScaleSource::kBodySize:
      return "body_size";
  }
  return "?";
}

GroundLine MakeGroundLine(core::PixelPoint p1, core::PixelPoint p2,
                          double u_point_px) {
  // Of two points one above the other the upper comes first: direction +90.
  if (p2.x_px < p1.x_px || (p2.x_px == p1.x_px && p2.y_px < p1.y_px)) {
    std::swap(p1, p2);
  }
  const double length = std::hypot(p2.x_px - p1.x_px, p2.y_px - p1.y_px);
  if (!(length > 0.0) || !std::isfinite(length)) {
    throw std::invalid_argument(
        "ground line's two points coincide or are not finite; give two "
        "different points on it");
  }
  if (!(u_point_px >= 0.0) || !std::isfinite(u_point_px)) {
    throw std::invalid_argument(
        "ground line's u_point_px must be at least 0 and finite");
  }
  GroundLine line;
  line.p1 = p1;
  line.p2 = p2;
  line.reference = {0.5 * (p1.x_px + p2.x_px), 0.5 * (p1.y_px + p2.y_px)};
  line.u_offset_px = u_point_px / std::sqrt(2.0);
  line.u_angle_rad = std::sqrt(2.0) * u_point_px / length;
  line.source = GroundSource::kUser;
  return line;
}

double ImageAngle(const GroundLine& ground) {
  return std::atan2(ground.p2.y_px - ground.p1.y_px,
                    ground.p2.x_px - ground.p1.x_px);
}

double HeightAboveLine(const GroundLine& ground, core::PixelPoint p) {
  const double angle = ImageAngle(ground);
  return (p.x_px - ground.p1.x_px) * std::sin(angle) -
         (p.y_px - ground.p1.y_px) * std::cos(angle);
}

double PositionOnLine(const GroundLine& ground, core::PixelPoint p) {
  const double angle = ImageAngle(ground);
  return (p.x_px - ground.reference.x_px) * std::cos(angle) +
         (p.y_px - ground.reference.y_px) * std::sin(angle);
}

namespace {

// The line through p and q, known as well as `like`.
GroundLine LineThroughPoints(core::PixelPoint p, core::PixelPoint q,
                             const GroundLine& like) {
  GroundLine line = MakeGroundLine(p, q, 0.0);
  line.u_offset_px = like.u_offset_px;
  line.u_angle_rad = like.u_angle_rad;
  line.source = like.source;
  return line;
}

}  // namespace

std::optional<GroundLine> Undistorted(const GroundLine& image,
                                      const Lens& lens) {
  const auto p = Undistort(lens, image.p1);
  const auto q = Undistort(lens, image.p2);
  const auto at = Undistort(lens, image.reference);
  if (!p || !q || !at) return std::nullopt;
  GroundLine line = LineThroughPoints(p->point, q->point, image);
  // The same place along the line, on it.
  const double along = PositionOnLine(line, at->point);
  const double angle = ImageAngle(line);
  line.reference.x_px += along * std::cos(angle);
  line.reference.y_px += along * std::sin(angle);
  return line;
}

GroundLine Distorted(const GroundLine& ideal, const Lens& lens,
                     core::PixelPoint a, core::PixelPoint b) {
  return LineThroughPoints(Distort(lens, a), Distort(lens, b), ideal);
}

}  // namespace touchdown::calib
