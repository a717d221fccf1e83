// Which places around a path move along it.
//
// Two layers (Wang and Adelson 1994, "Representing moving images with layers"):
// the picture T that goes along the path c, and the still one B behind it,
//   T(q) = median over frames of I(c + R q),
//   B(x) = median over frames of I(x) where what moves does not hide x.
// Of the frames in which the two differ clearly at a place q, those that are
// nearer to T(q) than to B(c + R q) are the share that moves. Where they never
// differ (a smooth wall beside the body, a part like the wall) nothing is said.
// In turns, as B needs to know what moves, first nothing but the part that the
// path is of.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "touchdown/calib/plane.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::vision {

// A square of places around a path's centre: (size, size), row by row.
struct CoMoving {
  int half = 0;             // places to each side
  double spacing_px = 1.0;  // of one to the next
  // 1: moves along, -1: is still, 0: not to be told.
  std::vector<signed char> says;

  int size() const { return 2 * half + 1; }
};

struct CoMovingOptions {
  double reach_px = 0.0;  // to each side
  bool turns = false;     // axes are those of the poses, which turn; else the
                          // image's
  // What lies below is not the body's: a shadow or a reflection on the ground
  // goes along, too.
  std::optional<calib::GroundLine> ground;
  int threads = 0;  // 0: one for each core; affects speed only
};

// What hides the still picture in the next round, from what the last one said
// (at first nothing): 1 for each place.
using CoverOfPlaces =
    std::function<std::vector<unsigned char>(const CoMoving&)>;

// `noise` tells the noise of a sample. Nothing moves along where there are
// fewer than 8 poses.
CoMoving FindCoMoving(Clip& clip, const Background& noise, const Track& path,
                      const CoverOfPlaces& cover,
                      const CoMovingOptions& options);

}  // namespace touchdown::vision
