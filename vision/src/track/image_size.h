// Whether the body's image keeps its size over a track.
#pragma once

#include "touchdown/vision/track/track.h"

namespace touchdown::vision {

// How the warning begins that it does not.
inline constexpr const char* kGrows = "the body's image changes size";

// Whether the body's image keeps its size; takes back that it does not.
bool IsSteady(const Track& track);
void KeepSize(Track& track);

}  // namespace touchdown::vision
