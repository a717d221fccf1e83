// The background, and what a track leaves of it uncovered.
#pragma once

#include <cstdint>

#include "touchdown/vision/background/background.h"
#include "touchdown/vision/tracking/tracker.h"

namespace touchdown::vision {

// Which pixels the body covers, and how often.
Covers FindTrackCovers(Clip& clip, const TrackOptions& options,
                       const Track& track);

// The background from what the track's body leaves uncovered, unknown where
// that is nothing (Background::unknown); `fallback` has the levels there.
Background EstimateUncovered(Clip& clip, const TrackOptions& options,
                             const Track& track, Background fallback);

// The background of all frames up to `last`, the body in it.
Background EstimateFromAll(Clip& clip, const TrackOptions& options,
                           std::int64_t last);

}  // namespace touchdown::vision
