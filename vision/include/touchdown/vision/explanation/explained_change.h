// The check by synthesis: how much of what changes in a clip does a track
// explain?
//
//   Q = 1 - (SS(I - rendered) - N s0^2) / (SS(I - temporal mean) - N s0^2)
//
// over sampled frames and pixels. SS is a sum of squares, s0 the noise of a
// pixel over time (median over pixels), N the number of samples. The rendered
// picture has two layers:
//   I = (1 - M) B + M T
//   M  coverage by the body of the track's shape at the track's pose, blurred
//      by its edge's blur and by its motion while the shutter is open
//   B  still picture, learned from what the poses leave uncovered
//   T  the body's own picture in the body's coordinates, learned from what the
//      poses cover
// The denominator knows no model. Q is 1 where the track explains all, 0 where
// it explains no more than "the picture is its own mean", and negative where
// the clip would be explained better without any body.
//
// What is not explained by convention:
//   - a pixel that is not wholly covered and whose B was never seen uncovered;
//   - a frame without a pose: the mean or B stands for it, whichever is nearer.
//     So a lost body counts as unexplained, and a body that has not entered
//     yet, or has left, does not count against the track.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "touchdown/core/expected.h"
#include "touchdown/core/points.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::vision {

struct ExplainedChangeOptions {
  // Frames sampled: evenly over the time in which the body is in view and half
  // as long before and after. Fewer leave more pixels that
  // no sampled frame shows uncovered; the cost grows in proportion. 24 is a
  // choice by cost, not yet measured against all frames.
  int frames = 24;

  // Of interest: four frames around it are sampled, too. Usually the contact.
  std::optional<double> frame_of_interest;

  // Samples per frame, at most about: near the body's path, and in the rest of
  // the picture. Pixels are taken on a lattice that is wide enough. The cost
  // grows in proportion; the error of Q as 1/sqrt.
  int points_near = 6000;
  int points_elsewhere = 2000;

  core::PixelRect region;  // that counts; width 0: the whole picture

  // Not empty: frames that are at hand whole (TrackOptions::still_frames); of a
  // clip that keeps windows only (Clip::KnownChanges) no other frame is read.
  std::vector<std::int64_t> still_frames = {};

  int threads = 0;  // 0: one for each core; affects speed only
};

struct ExplainedChange {
  // Q over the pixels within half the body's size of its outline in any sampled
  // frame: a body that was followed at a wrong place, or lost, counts. 0 where
  // what changes there does not stand out of the noise: no body moves.
  double near = 0.0;
  // Of the body's area, the share that is seen to be body: there T explains
  // what B does not. The rest lies beside a smaller body, or one of another
  // shape, which explains as much: of a size that is stated k times too large,
  // 1 / k^2. Within 2 px of the outline nothing is told. Absent where fewer
  // than 20 samples lie side by side within the body.
  std::optional<double> seen;
  // Of a rectangle: `near`, were the body the disc between its long sides, at
  // the same poses. Where the disc explains as much, the corners are not seen:
  // they may be the background about a ball.
  std::optional<double> near_as_disc;
  // Share of the clip's change beyond noise that lies farther from the body's
  // path, at points that stand out of the noise of their level. Nothing of it
  // is explained: Q is 0 there. Other things move, or the body was lost where
  // no pose is near. 0 .. 1.
  double elsewhere = 0.0;
  // Of all change in the clip, the share that is explained.
  double OfAll() const { return near * (1.0 - elsewhere); }

  // Mean square residual over s0^2 where the outline's blurred edge is (M from
  // 0.02 to 0.98): about 1 where shape, pose and blur are right and noise is
  // alike everywhere. Compressed clips have less noise where nothing moves, and
  // larger values. No limit is set on it.
  double band_chi2 = 0.0;
  double noise_dn = 0.0;  // s0

  int frames = 0;  // sampled
  int lost = 0;    // of them without a pose, between the first and the last one
  std::int64_t pixels = 0;  // samples near, all frames together
};

// Absent where the track has fewer than three poses in the sampled frames.
// Throws what Clip::Read throws; std::invalid_argument if a number of options
// is below its least (frames 3, points 100) or the clip is not the track's.
core::Expected<ExplainedChange> MeasureExplainedChange(
    Clip& clip, const Track& track, const ExplainedChangeOptions& options = {});

}  // namespace touchdown::vision
