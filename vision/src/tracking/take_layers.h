// Which result of the two-layer model is the answer: from outlines, from a
// layered start, or none.
#pragma once

#include <cstdint>
#include <optional>

#include "touchdown/core/expected.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/tracking/tracker.h"

namespace touchdown::vision {

// The body from a layered start (layered_track.h), in layers. Absent, with the
// reason, where there is no such start or layers do not follow it.
core::Expected<TrackResult> StartInLayers(Clip& clip,
                                          const TrackOptions& options,
                                          std::int64_t last,
                                          const Background& fallback);

// Whether a track, which is of the stated size, explains enough of what changes
// in the clip (explained_change.h) to end the search for the body.
bool ExplainsClip(Clip& clip, const TrackOptions& options, const Track& track);

// Replaces the result's outlines by the two-layer fit: from these outlines or,
// where they may be those of a ghost, from a layered start of the stated body:
// `started`, where it was made already. False, and nothing done, where layers
// are no better. `most_covered`: as in MayFollowGhost (layered_track.h).
bool TakeLayers(Clip& clip, const TrackOptions& options, double most_covered,
                std::optional<core::Expected<TrackResult>> started,
                TrackResult& result);

// Replaces a result that explains too little of the clip, of a body whose size
// nobody stated, by a layered start. False, and nothing done, where there is
// no such start.
bool TakeLayeredStart(Clip& clip, const TrackOptions& options,
                      std::int64_t last, TrackResult& result);

}  // namespace touchdown::vision
