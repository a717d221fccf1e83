#include "app/cli/analyze/calibrate_file.h"

#include <fmt/core.h>

#include <cmath>
#include <stdexcept>

#include "app/cli/options.h"
#include "app/cli/values.h"
#include "app/measure/new_calibration.h"
#include "touchdown/core/errors.h"

namespace touchdown::cli {

// `add` is false for `lens`: a calibration begins with its lens, and scale and
// ground are added to that file.
void AddFileFlags(CLI::App& command, CalibrationFileFlags& flags, bool add) {
  AddOption(command, "--out", flags.out,
            "the calibration file to write, e.g. camera.json")
      .Require();
  AddOption(command, "--camera", flags.camera, "the camera's name");
  const Option date =
      AddOption(command, "--date", flags.date,
                "day of the pictures, as in 2026-11-21 (default: today)");
  const Option valid_days =
      AddOption(command, "--valid-days", flags.valid_days,
                "after so many days `analyze` warns that it is old")
          .Between(1, 36500)
          .ShowDefault();
  AddOption(command, "--sensor-origin", flags.sensor_origin,
            "where the picture lies on the sensor, X,Y in pixels (default: as "
            "the file says, else 0,0)");
  if (add) {
    AddOption(command, "--calibration", flags.calibration,
              "a calibration of this camera to add to: its lens and its dates "
              "are used, and all of it goes into --out")
        .Exclude(date)
        .Exclude(valid_days);
  }
}

// A million pixels is far beyond any sensor, and fits an int32.
calib::SensorCorner ParseCorner(const std::string& flag,
                                const std::string& text) {
  const auto n = ParseNumbers(flag, text, 2, "X,Y in whole pixels, at least 0");
  for (const double v : n) {
    if (v < 0.0 || v > 1e6 || v != std::floor(v)) {
      throw std::invalid_argument(fmt::format(
          "{} is '{}', must be X,Y in whole pixels, at least 0", flag, text));
    }
  }
  return {static_cast<std::int32_t>(n[0]), static_cast<std::int32_t>(n[1])};
}

// `u_point_px` comes from --u-point-px of the same command: its error names
// that flag and not `flag`.
calib::MarkedPair ParsePair(const std::string& flag, const std::string& text,
                            double u_point_px) {
  const auto n =
      ParseNumbers(flag, text, 4, "two points X1,Y1,X2,Y2 in pixels");
  if (!(u_point_px >= 0.0) || !std::isfinite(u_point_px)) {
    throw std::invalid_argument(
        fmt::format("--u-point-px is {}, must be at least 0", u_point_px));
  }
  return {{n[0], n[1]}, {n[2], n[3]}, u_point_px};
}

// The corner decides later which recordings the calibration fits: a part of the
// sensor is moved into the calibrated picture by it.
calib::Picture DescribePicture(const CalibrationFileFlags& flags,
                               const StillPicture& picture) {
  calib::Picture out{picture.image.width_px, picture.image.height_px,
                     picture.corner};
  if (!flags.sensor_origin.empty()) {
    out.corner = ParseCorner("--sensor-origin", flags.sensor_origin);
  }
  return out;
}

calib::Calibration BeginCalibration(const CalibrationFileFlags& flags,
                                    const calib::Picture& picture) {
  calib::Calibration out;
  // A scale or ground is measured with the lens of the known file: that file
  // must fit the new picture, else its lens would be wrong there.
  if (!flags.calibration.empty()) {
    const auto known = calib::ReadCalibration(flags.calibration);
    auto fitted = calib::AdaptToPicture(known, picture);
    if (!fitted) {
      throw core::InputError(
          fmt::format("{}: {}", flags.calibration, fitted.error().reason));
    }
    out = *std::move(fitted);
    if (!flags.camera.empty()) out.camera = flags.camera;
    // The oldest part decides how long the whole is good, so --date and
    // --valid-days are refused beside --calibration.
    return out;
  }
  return pipeline::NewCalibration(flags.camera, picture, flags.date,
                                  flags.valid_days);
}

}  // namespace touchdown::cli
