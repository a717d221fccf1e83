// A track measured again by two layers: the picture behind the body and the
// body's own (layers/layer_model.h).
#pragma once

#include <optional>

#include "touchdown/core/expected.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/tracking/tracker.h"

namespace touchdown::vision {

// Covered in a smaller share of the frames, a pixel's mid-mean is untouched by
// the body but for a tenth of the noise.
inline constexpr double kUntouched = 0.2;

// Whether outlines leave more than noise of the body, or do not know what is
// behind it.
bool IsBadlyModelled(const Track& track);

// What TrackBody asks of a track, so that it is worth the time: a body that its
// outlines explain before a background that is known well needs no pictures.
// `most_covered`: the largest share of the frames in which the track covers one
// and the same pixel.
bool NeedsLayers(const Track& track, double most_covered);

// Whether outlines explain the body to the noise once highlights and occluders
// are known (Refine): a texture of any shape tells less of the sides then.
bool HasPlainFace(Clip& clip, const Background& background, const Track& track,
                  int threads);

// Whether marks show that a ball turns: its face changes by more than noise
// from frame to frame. Its outlines need no pictures, its spin does.
bool ShowsMarks(Clip& clip, const Background& background, const Track& track);

// The same body in all frames between the first and the last pose of `track`,
// which are within some pixels of the truth; Track::layered then. In light
// where that explains the levels better (BodyImage::gamma). `size`: what was
// stated. Absent, with the reason, where layers cannot be told apart.
core::Expected<Track> FollowInLayers(Clip& clip, const Background& background,
                                     const Track& track,
                                     const std::optional<BodySize>& size,
                                     int threads);

}  // namespace touchdown::vision
