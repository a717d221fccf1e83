// The first look at a clip: what moves in it, of what kind it is, and its
// outline in the frames looked at. Coarse to fine in time: a long clip is
// looked at in every eighth frame first, and more closely only as long as the
// body is there for few of these looks or moves far between them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "detection/chain.h"
#include "outline/track_shape.h"
#include "touchdown/vision/track/track_options.h"

namespace touchdown::vision {

// What was detected in the frames looked at.
struct Detections {
  std::vector<Chain> chains;  // the best one first
  std::int64_t last = 0;      // frames [first, last) could be read
  std::int64_t step = 1;      // every so many frames were looked at
  std::string warning;
  // Bounds of the search that were met, one sentence each.
  std::vector<std::string> bounds;
};

using Surround = OutlineOptions::Surround;

// What to fit, with the evidence.
struct Choice {
  core::BodyKind kind = core::BodyKind::kSphere;
  double badness = 1e9;
  double blur_px = 0.8;
};

struct Look {
  Background background;
  Detections found;
  Choice choice;
  Surround surround = Surround::kBackground;
  std::vector<Fitted> fits;  // of the best chain
  // Its blobs hold the body's shadow, too: many a fit began too far off.
  bool rough_starts = false;
};

// Frames at either end of a range of which a background is made where the body
// is part of the background of them all.
std::int64_t EndPart(std::int64_t first, std::int64_t last);

// What the still background is made of.
BackgroundOptions ChooseBackgroundOptions(const Clip& clip,
                                          const TrackOptions& options);

// A look against this background. It is less good than another (by IsBetter)
// where the background holds the body's ghost. Outlines are fitted only where
// it can still win against `rival`, and with `least_fits` outlines or more: a
// hypothesis that is wrong costs the most, because no outline converges.
Look TryHypothesis(Clip& clip, Background background,
                   const TrackOptions& options, Detector detector,
                   std::int64_t last, const Look* rival = nullptr,
                   double least_fits = 0.0);
bool IsBetter(const Look& look, const Look& other);

// What differs from the background of all frames, and its kind; outlines are
// not fitted yet.
Look LookPlainly(Clip& clip, const TrackOptions& options, std::int64_t last);

// The best of some hypotheses, of which the plain look is the first; it is the
// only one where outlines explain the body. Absent where nothing moves, or
// nothing with an outline.
core::Expected<Look> FirstLook(Clip& clip, const TrackOptions& options,
                               Look plain);

// Tries the kinds on a few frames spread over the chain, away from the border.
Choice ChooseKind(Clip& clip, const Background& background, const Chain& chain,
                  const TrackOptions& options, Surround surround);

// The outlines of a chain's links: of each, or from `first` on of every `step`.
struct LinkRange {
  std::size_t first = 0;
  std::size_t step = 1;
};
std::vector<Fitted> FitChain(Clip& clip, const Background& background,
                             const Chain& chain, const Choice& choice,
                             const TrackOptions& options, Surround surround,
                             const LinkRange& range = {});

// The first frame of [first, last) that cannot be read, with the reason; `last`
// where all can.
std::int64_t FirstUnreadable(Clip& clip, std::int64_t first, std::int64_t last,
                             std::string& reason);

}  // namespace touchdown::vision
