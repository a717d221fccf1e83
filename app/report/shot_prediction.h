// What the rig was expected to do in a trial, beside what was measured: plain
// data, made by app/shots/rig_prediction.h.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "touchdown/core/estimate.h"

namespace touchdown::report {

struct ShotPrediction {
  core::Measured launch_speed_mps = core::AbsentBecause("no rig");
  core::Measured approach_angle_rad = core::AbsentBecause("no rig");
  // Of the trial: its speed at touchdown less what the fall from the muzzle
  // added, v0^2 = v^2 - 2 g h.
  core::Measured measured_launch_speed_mps = core::AbsentBecause("no rig");
};

// The rig that threw the trials of a report.
struct RigUsed {
  std::vector<std::pair<std::string, std::string>> facts;  // name, value
  std::map<std::string, ShotPrediction> predictions;       // by trial id
};

}  // namespace touchdown::report
