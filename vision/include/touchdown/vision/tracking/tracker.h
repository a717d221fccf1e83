// From frames to the body's pose over time.
#pragma once

#include <optional>

#include "touchdown/calib/plane.h"
#include "touchdown/core/expected.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/track/track.h"
#include "touchdown/vision/track/track_options.h"

namespace touchdown::vision {

struct TrackResult {
  Track track;
  Background background;  // what is behind the body
};

// Follows the one moving body of a clip. Absent, with the reason, where nothing
// moves or no outline fits. Frames from the first unreadable one on are left
// out, with a warning in the track. Throws what Clip::Read throws for the first
// frame.
core::Expected<TrackResult> TrackBody(Clip& clip,
                                      const TrackOptions& options = {});

// Fits the outlines that TrackBody left out, from the poses around them.
Track FitEveryFrame(Clip& clip, const Background& background,
                    const Track& track, const TrackOptions& options = {});

struct RefineOptions {
  // Nothing: not known yet; the picture near it is then taken for the body's.
  std::optional<calib::GroundLine> ground;

  // Short over long side of a rectangle, where a person measured both: a block
  // that lies on the ground hides one of its edges.
  std::optional<core::Estimate> aspect;

  // Whether the caller compares the sizes with stated ones. Else they are
  // measured by the picture alone, and their u holds what a gamma that nobody
  // stated may do to outlines (ClipInfo::gamma_is_known).
  bool size_is_stated = false;

  int threads = 0;  // 0: one for each core; affects speed only
};

// Fits the outlines again with the ground line known, from the track's own
// poses, and for the first time where they were left out. The picture near the
// line is modelled (OutlineOptions::NearGround) where residuals say that it is
// what the body alone makes of it; else pixels lower than 2.5 w above the line
// (at most half of the smallest size) leave the fit. What all frames share is
// learnt first: size, blur, the share of the frame interval that is exposed,
// and the body's shading; then it is held, so that a pose no longer depends on
// what is free in each frame. Frames in which something hides a part of the
// body, so that it looks smaller, are left out.
Track Refine(Clip& clip, const Background& background, const Track& track,
             const RefineOptions& options);

}  // namespace touchdown::vision
