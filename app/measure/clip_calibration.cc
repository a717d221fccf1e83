#include "app/measure/clip_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

// "1.25 +- 0.10 deg".
std::string AngleText(const core::Estimate& e) {
  return fmt::format("{:.2f} +- {:.2f} deg", e.value / core::kDegree,
                     e.u / core::kDegree);
}

}  // namespace

ClipCalibration FitToClip(const AnalyzeOptions& options,
                          const vision::ClipInfo& clip) {
  ClipCalibration out;
  out.image_ground = options.ground;
  if (options.calibration) {
    // Where the picture lies on the sensor: said by the user, else by the file;
    // AdaptToPicture says no where neither does and the sizes differ.
    calib::Picture picture{clip.width_px, clip.height_px, options.crop};
    if (!picture.corner && clip.sensor_origin) {
      picture.corner = calib::SensorCorner{clip.sensor_origin->x_px,
                                           clip.sensor_origin->y_px};
    }
    auto fitted = calib::AdaptToPicture(*options.calibration, picture);
    if (!fitted) {
      throw core::InputError(
          fmt::format("{}: {}", clip.path.string(), fitted.error().reason));
    }
    const calib::Calibration& calibration =
        out.calibration.emplace(*std::move(fitted));
    if (calibration.lens) out.lens = calibration.lens->lens;
    // The age is asked for a fresh analysis; a stored trial that is judged
    // again was made with the calibration of its day.
    if (!options.today.empty()) {
      if (auto old = calib::AgeWarning(calibration, options.today)) {
        out.warnings.push_back(*std::move(old));
      }
    }
    // A ground that is given for this clip comes before the calibrated one.
    if (calibration.ground && !out.image_ground) {
      const calib::GroundRecord& ground = *calibration.ground;
      out.image_ground =
          calib::MakeGroundLine(ground.p1, ground.p2, ground.u_point_px);
      out.image_ground->source = calib::GroundSource::kCalibration;
    }
    if (calibration.ground) out.yaw_rad = calibration.ground->yaw_rad;
    if (calibration.ground && calibration.ground->slope_rad) {
      // Along the normal of a ground that slopes by s acts g cos(s), with u(g
      // cos s)^2 = u(g)^2 + (g sin(s) u(s))^2 (JCGM 100, equation 10).
      const core::Estimate& slope = *calibration.ground->slope_rad;
      core::Estimate& gravity = out.gravity_mps2;
      gravity.u = std::hypot(gravity.u,
                             gravity.value * std::sin(slope.value) * slope.u);
      gravity.value *= std::cos(slope.value);
    }
  }
  // Two points in the image, wherever they come from, become a straight line of
  // the picture without distortion; the model of the lens holds within the
  // calibrated picture only.
  out.ideal_ground = out.image_ground;
  if (out.lens && out.image_ground) {
    out.ideal_ground = calib::Undistorted(*out.image_ground, *out.lens);
    if (!out.ideal_ground) {
      throw std::invalid_argument(
          "ground has a point so far outside the picture that the lens model "
          "does not hold there; give two points within the picture");
    }
  }
  return out;
}

vision::PlaneYaw MakePlaneYaw(double yaw_rad,
                              const std::optional<calib::Lens>& lens) {
  vision::PlaneYaw yaw;
  yaw.yaw_rad = yaw_rad;
  if (lens) {
    // Perspective needs the focal length; without a lens the turned plane is
    // seen from infinitely far.
    yaw.focal_px = calib::IdealFocal(*lens);
    yaw.axis = {lens->cx_px, lens->cy_px};
  }
  return yaw;
}

std::optional<vision::PlaneYaw> CalibratedYaw(const ClipCalibration& camera) {
  if (!camera.yaw_rad) return std::nullopt;
  return MakePlaneYaw(camera.yaw_rad->value, camera.lens);
}

void DescribeCalibration(const std::optional<calib::Calibration>& calibration,
                         SceneModel& scene) {
  scene.used.emplace_back("roll, by the ground line: angles are to it");
  // Each effect is left out until the calibration turns out to hold it.
  scene.left_out["perspective"] = "no calibration";
  scene.left_out["yaw"] = "no calibration";
  if (!calibration) {
    scene.left_out["lens distortion"] = "no calibration";
    return;
  }
  if (calibration->lens) {
    scene.used.push_back("lens (Brown), calibrated on " + calibration->date);
  } else {
    scene.left_out["lens distortion"] = "the calibration has no lens";
  }
  scene.left_out["perspective"] = "the calibration has no board on the ground";
  scene.left_out["yaw"] = "the calibration has no board on the ground";
  if (!calibration->ground) return;
  if (const auto& yaw = calibration->ground->yaw_rad) {
    scene.used.push_back("yaw of the plane of travel, " + AngleText(*yaw));
    scene.left_out.erase("yaw");
    if (calibration->lens) {
      scene.left_out["perspective"] = "but for the yaw: the camera is level";
    } else {
      scene.left_out["yaw off the axis"] =
          "the calibration has no lens: its focal length is not known";
    }
  }
  if (const auto& slope = calibration->ground->slope_rad) {
    scene.used.emplace_back("slope of the ground, in gravity along its normal");
    scene.left_out["gravity along the ground"] = "slope " + AngleText(*slope);
  }
}

calib::GroundLine SeenGroundLine(const vision::PlaneTrack& plane,
                                 const calib::Lens& lens) {
  // The stretch of the ground beside which the body was seen, half a size
  // longer at both ends: over it the chord fits the bent line best.
  double from = 0.0;
  double to = 0.0;
  bool any = false;
  for (const vision::PlaneSample& s : plane.samples) {
    if (std::abs(s.gap_px) > 0.5 * plane.size_px) continue;
    from = any ? std::min(from, s.along_px) : s.along_px;
    to = any ? std::max(to, s.along_px) : s.along_px;
    any = true;
  }
  const double half = 0.5 * plane.size_px;
  return calib::Distorted(plane.ground, lens,
                          vision::ToImage(plane, from - half, 0.0),
                          vision::ToImage(plane, to + half, 0.0));
}

std::vector<core::PixelPoint> SeenPoints(const calib::GroundLine& ideal,
                                         const calib::Lens& lens, int count) {
  std::vector<core::PixelPoint> seen;
  for (int i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / (count - 1);
    seen.push_back(calib::Distort(
        lens, {ideal.p1.x_px + t * (ideal.p2.x_px - ideal.p1.x_px),
               ideal.p1.y_px + t * (ideal.p2.y_px - ideal.p1.y_px)}));
  }
  return seen;
}

std::optional<calib::GroundLine> ThroughPoints(
    const std::vector<core::PixelPoint>& seen, const calib::Lens& lens,
    const calib::GroundLine& like) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const core::PixelPoint& p : seen) {
    const auto ideal = calib::Undistort(lens, p);
    if (!ideal) return std::nullopt;
    // From the reference point, so that nothing cancels.
    const double x = ideal->point.x_px - like.reference.x_px;
    const double y = ideal->point.y_px - like.reference.y_px;
    n += 1.0;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  // Least squares of y over x. A ground line is not vertical, so that the
  // denominator is not small.
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  const double offset = (sy - slope * sx) / n;
  const auto at = [&](double x_px) {
    const double x = x_px - like.reference.x_px;
    return core::PixelPoint{x_px, like.reference.y_px + offset + slope * x};
  };
  calib::GroundLine line = like;
  line.p1 = at(like.p1.x_px);
  line.p2 = at(like.p2.x_px);
  line.reference = at(like.reference.x_px);
  return line;
}

}  // namespace touchdown::pipeline
