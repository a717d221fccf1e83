// A calibration as it fits one clip, and the ground line between the image and
// the lens's ideal picture.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/measure/analyze.h"
#include "touchdown/calib/calibration_file.h"
#include "touchdown/calib/lens.h"
#include "touchdown/calib/plane.h"
#include "touchdown/core/estimate.h"
#include "touchdown/vision/contact/contact.h"
#include "touchdown/vision/contact/plane_yaw.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::pipeline {

struct ClipCalibration {
  std::optional<calib::Calibration> calibration;  // in the clip's coordinates
  std::optional<calib::Lens> lens;
  // The ground that was given, or else calibrated: in the image, and in the
  // ideal picture (the same without a lens).
  std::optional<calib::GroundLine> image_ground;
  std::optional<calib::GroundLine> ideal_ground;
  // Of the plane of travel; with a focal length where there is a lens.
  std::optional<core::Estimate> yaw_rad;
  // Its part along the ground's normal.
  core::Estimate gravity_mps2 = vision::ContactOptions{}.gravity_mps2;
  std::vector<std::string> warnings;
};

// Throws core::InputError naming the clip where the calibration is not of it,
// and std::invalid_argument where the ground that was given lies outside the
// lens model.
ClipCalibration FitToClip(const AnalyzeOptions& options,
                          const vision::ClipInfo& clip);

// The yaw for vision::SeenFromGround; of `yaw_rad`, which need not be the
// calibrated one, with this lens.
vision::PlaneYaw MakePlaneYaw(double yaw_rad,
                              const std::optional<calib::Lens>& lens);

// The same as calibrated; nothing where no calibration tells the yaw.
std::optional<vision::PlaneYaw> CalibratedYaw(const ClipCalibration& camera);

// What the calibration adds to the scene model, or why something is left out.
void DescribeCalibration(const std::optional<calib::Calibration>& calibration,
                         SceneModel& scene);

// plane.ground as the camera sees it where the body is within half its size of
// it: the lens bends the line, and a straight one can follow it over the part
// that matters.
calib::GroundLine SeenGroundLine(const vision::PlaneTrack& plane,
                                 const calib::Lens& lens);

// `count` points of the image at which an ideal line is seen, from p1 to p2.
std::vector<core::PixelPoint> SeenPoints(const calib::GroundLine& ideal,
                                         const calib::Lens& lens, int count);

// The line nearest to points of the image in the ideal picture of `lens` (least
// squares of y), known as well as `like`. Nothing where the lens has no ideal
// point for one of them.
std::optional<calib::GroundLine> ThroughPoints(
    const std::vector<core::PixelPoint>& seen, const calib::Lens& lens,
    const calib::GroundLine& like);

}  // namespace touchdown::pipeline
