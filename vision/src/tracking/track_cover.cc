#include "tracking/track_cover.h"

#include <utility>

#include "detection/first_look.h"
#include "outline/body_cover.h"

namespace touchdown::vision {

Covers FindTrackCovers(Clip& clip, const TrackOptions& options,
                       const Track& track) {
  const BodyCover cover(clip, track);
  return FindCovers(
      options.first, track.last_frame,
      [&cover](std::int64_t frame) { return cover.CoverInFrame(frame); },
      ChooseBackgroundOptions(clip, options));
}

Background EstimateUncovered(Clip& clip, const TrackOptions& options,
                             const Track& track, Background fallback) {
  return EstimateMaskedBackground(clip, FindTrackCovers(clip, options, track),
                                  std::move(fallback),
                                  ChooseBackgroundOptions(clip, options));
}

Background EstimateFromAll(Clip& clip, const TrackOptions& options,
                           std::int64_t last) {
  return EstimateBackground(clip, options.first, last,
                            ChooseBackgroundOptions(clip, options));
}

}  // namespace touchdown::vision
