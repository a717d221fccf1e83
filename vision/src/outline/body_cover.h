// Where the body of a track is in a frame: for a background without it.
#pragma once

#include <cstdint>
#include <optional>

#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::vision {

// On the straight way from pose `a` to pose `b`, or beyond: what `frame` would
// see at a steady pace. All else is as in `a`.
Pose OnTheWay(const Pose& a, const Pose& b, std::int64_t frame);

// The pose in a frame: measured, or between two measured ones; nothing outside
// the track.
std::optional<Pose> InterpolatePose(const Track& track, std::int64_t frame);

// What the body covers, frame by frame. Before the track begins and after it
// ends the picture may be empty, or the body may rest where the track begins or
// ends, unmoved and so unseen: there the frame itself is asked.
class BodyCover {
 public:
  BodyCover(Clip& clip, const Track& track);

  Cover CoverInFrame(std::int64_t frame) const;

 private:
  bool IsAbsent(std::int64_t frame) const;
  Cover ComputeCover(const Pose& pose) const;

  Clip& clip_;
  const Track& track_;
  double level_first_ = 0.0;
  double level_last_ = 0.0;
  double cover_inside_ = 1.0;  // what the blur leaves of the contrast there
};

}  // namespace touchdown::vision
