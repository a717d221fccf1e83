// Where a body is from the first frame to the last, found together with the
// still picture behind it; and its size, where nobody stated it.
//
// A mean or median over the frames shows the body itself where it covers a
// pixel in half of them, and a search in what differs from that follows its
// ghost. Here picture and path are estimated in turn:
//   B = median over the sampled frames, known everywhere
//   some times, but for the last B, or once if the path leaves this B right:
//     E_t = clip((G * |I_t - B| - 0.8 s) / (5 s + c), 0, 1); 0.5 where B is not
//           known                                           (change, in noise)
//     p_t = the smooth path through the places where E_t has the body's shape
//     B   = robust mean of the pixels outside of the shape (grown) at p_t,
//           known where at least one frame shows it
// A ghost does not move, so that a smooth path passes over it; with the body
// left out it is gone from the next B. Where the path costs much
// (path_linking.h), B is begun a second and a third time, with what the first
// and the last frame show without the body (pair_of_places.h), and the path
// that leaves the least change unexplained is the answer: a body that goes less
// than its own length is most of the median. s: noise of the reduced picture,
// G: a Gaussian of 1 px of it, c: see the source.
//
// Where the size is not known, shape and path are found in turn, too
// (shape_along_path.h), from some shapes of the area that changes. Of all
// shapes and paths the answer leaves the least change unexplained.
#pragma once

#include <cstdint>
#include <vector>

#include "detection/shape_search.h"
#include "touchdown/core/expected.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

struct LayeredStartOptions {
  // Frames [first, last) to search; last < 0: to the end.
  std::int64_t first = 0;
  std::int64_t last = -1;

  // px. Of FindSizedStart the kind alone counts.
  KnownShape shape;

  // About so many frames are looked at, evenly spread. Fewer cost less time and
  // show less of what is behind the body; between two of them it may move by
  // about its own size. 48: a body that needs 40 frames to leave its place is
  // seen to do so.
  int frames = 48;

  // At most. Of 48 clips half are at rest after two, a sixth needs four to
  // six; some of those that are not by then never are.
  int rounds = 6;
  int threads = 0;  // 0: one for each core; affects speed only
};

// The body in one sampled frame.
struct StartPose {
  std::int64_t frame = 0;
  core::PixelPoint centre;
  double angle_rad = 0.0;  // continuous over the frames
  double score = 0.0;      // mean change under the shape, 0 to 1
  bool seen = true;        // false: the score is far below that of the others
};

// By frame, of all sampled frames. Absent, with the reason, where nothing of
// the shape moves. Whether it is all that changes is for the one who measured
// it to ask (explained_change.h). Throws what Clip::Read throws;
// std::invalid_argument for a shape without size.
core::Expected<std::vector<StartPose>> FindLayeredStart(
    Clip& clip, const LayeredStartOptions& options);

struct SizedStart {
  KnownShape shape;  // px, to some tenths of its sides
  std::vector<StartPose> poses;
  double unexplained = 0.0;  // MeasureUnexplained
};

// The same of a body of this kind whose size is not known. Throws what
// Clip::Read throws.
core::Expected<SizedStart> FindSizedStart(Clip& clip,
                                          const LayeredStartOptions& options);

}  // namespace touchdown::vision
