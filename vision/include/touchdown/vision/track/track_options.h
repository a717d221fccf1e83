// What is told of a clip before the body is sought in it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "touchdown/calib/plane.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/points.h"
#include "touchdown/core/words.h"

namespace touchdown::vision {

struct Track;

// Of the body in the picture, where scale and sides are known, with u of both.
struct BodySize {
  core::Estimate long_px;   // long side of a rectangle, diameter of a sphere
  core::Estimate short_px;  // short side; a sphere's diameter
};

struct TrackOptions {
  // Frames [first, last) to search; last < 0: to the end.
  std::int64_t first = 0;
  std::int64_t last = -1;

  core::PixelRect region;  // searched; width 0: the whole picture

  // Nothing: sphere or rectangle, whichever outline fits the pixels better.
  std::optional<core::BodyKind> kind;

  // Whether a person measured the body, of which nothing may be known in px: a
  // ball then is a whole circle, whatever its face shows.
  bool measured = false;

  // Given with `kind`: what is followed must be of this size. Where outlines
  // explain the body badly, or the track may be that of a ghost (the body
  // covers a pixel in three quarters of the frames, or the size found is
  // another), the body is sought together with the picture behind it
  // (src/detection/layered_start.h). Nothing: not asked.
  std::optional<BodySize> size;

  // Pixels below it are left out of the outline's fit.
  std::optional<calib::GroundLine> ground;

  // Clips of no more pixels, in all frames together, are seen whole, in every
  // frame: shadows and reflections, which tell that luma is a bad witness, are
  // too faint for a short look in compressed pictures. 2e8: a second or two.
  double seen_whole_px = 2e8;

  // About so many frames of a long clip are looked at to find the body's stay,
  // at the least every eighth; what is shorter is looked at in every frame.
  // Of raw clips some rows of as many frames, at the least every 32nd, are
  // glimpsed at first. More cost time; a body that is in view for fewer than
  // eight frames (32 of a raw clip) is found at a second look only if nothing
  // else was seen, or something near it in time.
  std::int64_t first_looks = 125;

  // Frames that the still background is made of. 0: 33, and 64 of a clip that
  // is seen whole and not colour video (whose frames repeat each other): a slow
  // body is in fewer of them at any pixel.
  int background_samples = 0;

  // Not empty: the frames that backgrounds may be made of
  // (BackgroundOptions::among).
  std::vector<std::int64_t> still_frames = {};

  // False: of a raw clip that was looked at every so many frames, the frames of
  // a smooth path are left to Refine (Track::step). Near blows, at both ends
  // and where the body is not wholly seen every frame is fitted all the same.
  bool every_frame = true;

  int threads = 0;  // 0: one for each core; affects speed only

  // Called now and then with the share done, 0..1; may be empty.
  std::function<void(double)> progress;
};

}  // namespace touchdown::vision
