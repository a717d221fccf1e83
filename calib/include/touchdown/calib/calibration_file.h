// What is known of a camera, as a file: schema "touchdown.calibration/1"
// (calib/README.md lists its fields). A file carries a lens, a scale, a ground
// line, or several of them; it says of which picture it is, and refuses others.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "touchdown/calib/lens.h"
#include "touchdown/calib/plane.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/expected.h"

namespace touchdown::calib {

// Where pixel (0, 0) of a recorded picture lies on the sensor.
struct SensorCorner {
  std::int32_t x_px = 0;
  std::int32_t y_px = 0;

  friend bool operator==(const SensorCorner&, const SensorCorner&) = default;
};

// Of a recording.
struct Picture {
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  std::optional<SensorCorner> corner;  // absent: the recording does not say
};

struct LensRecord {
  Lens lens;
  LensCovariance covariance = LensCovariance::Zero();
  std::string board;
  double rms_px = 0.0;
  double coverage = 0.0;  // share of the picture's cells with corners
  struct View {
    std::string name;
    double rms_px = 0.0;
  };
  std::vector<View> views;
};

struct ScaleRecord {
  core::Estimate px_per_m;  // of the ideal picture where there is a lens
  double length_m = 0.0;    // that it was measured by
  // Error of another known length, measured by this scale.
  std::optional<core::Estimate> check_error_m;
};

struct GroundRecord {
  core::PixelPoint p1;  // as seen in the picture
  core::PixelPoint p2;
  double u_point_px = 0.0;  // of each, along the normal
  // Of the ground to the level, by a plumb line; positive where the ground
  // rises to the right in the picture.
  std::optional<core::Estimate> slope_rad;
  // Of the plane of travel to the picture's plane, by a board on the ground.
  std::optional<core::Estimate> yaw_rad;
};

struct Calibration {
  std::string camera;   // its name, as people call it
  std::string date;     // of the pictures, YYYY-MM-DD
  std::string expires;  // last day of its validity, YYYY-MM-DD
  Picture picture;
  std::optional<LensRecord> lens;
  std::optional<ScaleRecord> scale;
  std::optional<GroundRecord> ground;
};

// Whether `text` is a day, as in 2026-11-21.
bool IsDate(std::string_view text);

// Throws core::InputError naming `source` and the field that is missing or
// impossible.
Calibration ParseCalibration(const std::string& text,
                             const std::string& source);
Calibration ReadCalibration(const std::filesystem::path& path);

// ParseCalibration gives back the same numbers.
std::string CalibrationText(const Calibration& calibration);

// The file appears under its name only when it is complete. Throws
// core::InputError naming it if it cannot be written.
void WriteCalibration(const std::filesystem::path& path,
                      const Calibration& calibration);

// The calibration in the coordinates of `picture`: the same where the pictures
// are the same part of the sensor, moved where `picture` is a part of the
// calibrated one. Absent, with the reason, where it does not fit: another
// resolution, a part of which the place is not known, or one that reaches
// beyond what was calibrated.
core::Expected<Calibration> AdaptToPicture(const Calibration& calibration,
                                           const Picture& picture);

// One sentence where the calibration is no longer valid on `today`
// (YYYY-MM-DD), or is dated later.
std::optional<std::string> AgeWarning(const Calibration& calibration,
                                      std::string_view today);

}  // namespace touchdown::calib
