// What `touchdown calibrate lens|scale|ground` have in common: the pictures
// they read and the file they write.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/cli/command.h"
#include "app/measure/board_pictures.h"
#include "app/measure/new_calibration.h"
#include "touchdown/calib/calibration_file.h"
#include "touchdown/calib/references.h"

namespace touchdown::cli {

struct CalibrationFileFlags {
  std::string camera;
  std::string date;
  int valid_days = pipeline::kValidDays;
  std::string sensor_origin;
  std::string calibration;
  std::string out;
};

// `add`: with --calibration, the file to be added to.
void AddFileFlags(CLI::App& command, CalibrationFileFlags& flags, bool add);

using pipeline::ReadPicture;
using pipeline::StillPicture;

// The calibration that the command begins with: the file of --calibration, as
// it fits the picture, with its own dates; or an empty one with those of the
// flags. A name of the flags goes before the file's.
calib::Calibration BeginCalibration(const CalibrationFileFlags& flags,
                                    const calib::Picture& picture);

// Of a picture that was read; --sensor-origin wins over the file's own.
calib::Picture DescribePicture(const CalibrationFileFlags& flags,
                               const StillPicture& picture);

// "X,Y", whole pixels, at least 0.
calib::SensorCorner ParseCorner(const std::string& flag,
                                const std::string& text);

// "X1,Y1,X2,Y2".
calib::MarkedPair ParsePair(const std::string& flag, const std::string& text,
                            double u_point_px);

void AddCalibrateScale(CLI::App& calibrate, Action& action);
void AddCalibrateGround(CLI::App& calibrate, Action& action);

}  // namespace touchdown::cli
