// A calibration as it begins, before anything is measured.
#pragma once

#include <string>

#include "touchdown/calib/calibration_file.h"

namespace touchdown::pipeline {

// After so many days `analyze` warns that it is old. 365: a camera that stays
// where it is moves by the seasons.
inline constexpr int kValidDays = 365;

// Of pictures made on `date` (YYYY-MM-DD; empty: today), whose corner is the
// sensor's where they do not say. Throws std::invalid_argument where `date` is
// no day.
calib::Calibration NewCalibration(const std::string& camera,
                                  const calib::Picture& picture,
                                  const std::string& date = "",
                                  int valid_days = kValidDays);

}  // namespace touchdown::pipeline
