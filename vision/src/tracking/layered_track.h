// The track from a layered start (detection/layered_start.h), and whether one
// can be made and is worth its time.
#pragma once

#include <cstdint>

#include "touchdown/core/expected.h"
#include "touchdown/vision/tracking/tracker.h"

namespace touchdown::vision {

// Whether the picture of a body has the stated size, but for what gamma, blur
// and rims do to its edges.
bool IsOfSize(const BodyImage& body, const BodySize& size);

// Whether a track may be that of a ghost, so that a second opinion is worth its
// time: the body is the background somewhere, or the stated body is not seen
// well modelled in nine of ten frames. `most_covered`: the largest share of the
// frames in which the track covers one and the same pixel. False where no size
// is stated, and of clips that are not at hand whole (Clip::KnownChanges) or
// longer than 400 frames.
bool MayFollowGhost(const Clip& clip, const TrackOptions& options,
                    const Track& track, double most_covered);

// Whether a layered start can be tried: as above but for the size, and in the
// whole picture only (TrackOptions::region).
bool CanStartFromLayers(const Clip& clip, const TrackOptions& options);

// Outlines from the poses of a layered start, before a background of what they
// leave uncovered (Background::unknown where nothing is); `fallback` has the
// levels there. Absent, with the reason, where there is no such start, or fewer
// than three outlines of the size: the stated one, else that of the start.
// `last`: frames up to it can be read.
core::Expected<TrackResult> TrackFromLayers(Clip& clip,
                                            const TrackOptions& options,
                                            std::int64_t last,
                                            const Background& fallback);

}  // namespace touchdown::vision
