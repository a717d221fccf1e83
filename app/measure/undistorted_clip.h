// A recording as a lens without distortion would have shown it: for people to
// look at, with straight lines and flights drawn in. Nothing is measured in it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "app/measure/analyze.h"
#include "touchdown/calib/lens.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::pipeline {

// Levels between pixels are interpolated linearly; what the camera did not see
// is 0. Windows are not read faster than whole pictures.
std::unique_ptr<vision::Clip> UndistortedClip(
    std::unique_ptr<vision::Clip> clip, const calib::Lens& lens);

// A recording with its track as lines are drawn into it: undistorted, where a
// lens was undone, and put back, where the camera moved.
struct Drawable {
  std::unique_ptr<vision::Clip> clip;
  vision::Track track;
};

// The frames, first and one past the last, of which the camera's motion was
// taken out (vision::PutBack): all that is told of the picture is told of the
// first of them. Nothing where the camera stood still.
std::optional<std::pair<std::int64_t, std::int64_t>> SteadyFrames(
    const Analysis& analysis);

// Opens the analysis's recording again; it must have a track. Throws
// core::InputError where that cannot be read.
Drawable OpenToDraw(const Analysis& analysis);

}  // namespace touchdown::pipeline
