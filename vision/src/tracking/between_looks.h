// The body's path between frames that were looked at. Where it is smooth, it
// tells where an outline is to be sought there, and one fit, the last, is
// enough.
#pragma once

#include <cstdint>
#include <vector>

#include "outline/track_shape.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::vision {

// Whether the frames from poses[i] to poses[i + 1] can be left out for now.
// `fits` are what the poses were made of, one each. They are `step` frames
// apart, as are those before and after them; all four show the whole body well;
// and each of the two lies where the cubic through the two looks on either side
// of it goes, in place and attitude. What a blow bends by more than 0.1 px, or
// five times u, does not: it bends four looks, so that two looks before it and
// two after it remain. False for the last one.
std::vector<bool> CanBeBridged(const std::vector<Fitted>& fits,
                               const std::vector<Pose>& poses,
                               std::int64_t step);

// Whether the outlines grow or shrink by so much from the first third to the
// last one that all of them should say how: 0.5 %.
bool MayChangeSize(const std::vector<Fitted>& fits);

// The same track with a pose in every frame between two that are `track.step`
// frames apart: on the cubic through them and the poses as far before and after
// them, or straight on where there are none. u are those of the nearer.
Track Bridged(const Track& track);

}  // namespace touchdown::vision
