// What turns pixels into plane metres, with uncertainties: the ground line and
// the scale.
#pragma once

#include <optional>
#include <string_view>

#include "touchdown/calib/lens.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/points.h"

namespace touchdown::calib {

// Where a ground line or a scale comes from.
enum class GroundSource { kCalibration, kUser, kDetected, kContactPoints };
enum class ScaleSource { kCalibration, kUser, kBodySize };
std::string_view Name(GroundSource source);  // "calibration", "user", ...
std::string_view Name(ScaleSource source);   // "calibration", "user", ...

// The ground line in the image, through two points, with the uncertainty of its
// height and direction at its own reference point (where the two do not
// correlate).
struct GroundLine {
  core::PixelPoint p1;  // smaller x
  core::PixelPoint p2;
  core::PixelPoint reference;  // on the line
  double u_offset_px = 0.0;    // of the normal distance, at `reference`
  double u_angle_rad = 0.0;    // of the direction
  GroundSource source = GroundSource::kUser;
  double wave_px = 0.0;  // amplitude of the edge about it, where it is wavy
};

// A ground line through two points given by a person, each good to
// `u_point_px` along the normal (default 0.5 px: a careful mouse click; it
// enters the angle's uncertainty as sqrt(2) u / length). Throws
// std::invalid_argument if the points coincide.
GroundLine MakeGroundLine(core::PixelPoint p1, core::PixelPoint p2,
                          double u_point_px = 0.5);

// Direction of the line in the image: angle from +x towards +y (image y points
// down), in (-pi/2, pi/2].
double ImageAngle(const GroundLine& ground);

// Signed distance of `p` above the line (towards smaller image y), in px.
double HeightAboveLine(const GroundLine& ground, core::PixelPoint p);

// Position of the foot of `p` along the line, from `reference`, in px.
double PositionOnLine(const GroundLine& ground, core::PixelPoint p);

// A line through the same two points in the lens's ideal picture, and back:
// the line through the two points at which the ideal points `a` and `b` of it
// are seen (between them the ground's image is bent). Uncertainties stay as
// they are, in px: distortion changes them by its own slope, a few per cent.
// Nothing where the lens has no ideal point for one of them.
std::optional<GroundLine> Undistorted(const GroundLine& image,
                                      const Lens& lens);
GroundLine Distorted(const GroundLine& ideal, const Lens& lens,
                     core::PixelPoint a, core::PixelPoint b);

struct Scale {
  core::Estimate px_per_m;
  ScaleSource source = ScaleSource::kUser;
};

}  // namespace touchdown::calib
