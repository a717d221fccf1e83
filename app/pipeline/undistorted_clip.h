// A recording as a lens without distortion would have shown it: for people to
// look at, with straight lines and flights drawn in. Nothing is measured in it.
#pragma once

#include <memory>

#include "touchdown/calib/lens.h"
#include "touchdown/vision/clip.h"

namespace touchdown::pipeline {

// Levels between pixels are interpolated linearly; what the camera did not see
// is 0. Windows are not read faster than whole pictures.
std::unique_ptr<vision::Clip> UndistortedClip(
    std::unique_ptr<vision::Clip> clip, const calib::Lens& lens);

}  // namespace touchdown::pipeline
