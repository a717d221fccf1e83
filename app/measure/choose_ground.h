// Which line is the ground: the one in the picture that the body's path agrees
// with, or else the line that the path itself draws. Reads no pixel.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/measure/clip_calibration.h"
#include "touchdown/calib/plane.h"
#include "touchdown/vision/contact/contact.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::pipeline {

struct GroundChoice {
  std::optional<calib::GroundLine> line;  // nothing where no line is the ground
  // The body meets the line, and nothing that it does refutes it as the ground.
  bool serves = false;
  std::vector<std::string> warnings;  // why it is none of the visible lines
};

// `visible`: lines of the picture, the likeliest first. `seen`: the track in
// the ideal picture (ToIdealPicture). `options`: how contacts are found.
GroundChoice ChooseGround(const std::vector<calib::GroundLine>& visible,
                          const ClipCalibration& camera,
                          const vision::Track& seen,
                          const vision::ContactOptions& options);

}  // namespace touchdown::pipeline
