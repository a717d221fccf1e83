// The whole of a body of which a part was followed.
//
// Of a body of several parts, or one that is partly like what lies behind it,
// a first look may follow what stands out most: an end, a bright strip. The
// whole moves with it (co_moving.h).
#pragma once

#include <optional>

#include "detection/chain.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/track/track.h"
#include "touchdown/vision/track/track_options.h"

namespace touchdown::vision {

// The track of the whole, in the frames of the part's and as smooth as that;
// nothing where no clearly larger outline holds what moves with the part, or
// the part's poses are those of looks only. Of the options kind, ground and
// threads count.
std::optional<Track> FindWhole(Clip& clip, const Background& background,
                               const Track& part, const TrackOptions& options);

// The path of a chain's blobs, of a body that few outlines fit: good to a pixel
// or two, which is enough to see what moves along.
Track MakePath(const Chain& chain, const Track& like);

}  // namespace touchdown::vision
