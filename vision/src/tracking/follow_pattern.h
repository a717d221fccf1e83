// A track measured again by the pattern of its body, where outlines are bad
// witnesses.
#pragma once

#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::vision {

// The same body followed by its pattern (pattern.h), in all frames where it is
// found; Track::patterned then. Where that tells clearly less of the path, or
// it is no matter for a pattern, the track as it was: not crudely modelled
// (kCrude), of changing size, before an unknown background, not fitted in every
// frame, in fewer than 8 frames.
Track FollowPattern(Clip& clip, const Background& background,
                    const Track& track, int threads);

// `outlines`, fits of the same body, say where a patterned track's pattern lies
// on it; poses are those of the pattern.
Track AlignToOutlines(const Track& outlines, const Track& patterned);

}  // namespace touchdown::vision
