// A clip as a camera that stands still would have shown it: a hand, a ladder or
// a tripod beside the ejector moves, and with it all that is measured against
// the ground.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "touchdown/core/estimate.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

// Where a point x of one frame lies in another, about the picture's centre c:
//
//   x' = c + [1 + grow, -turn; turn, 1 + grow] (x - c) + shift
struct Similarity {
  double shift_x_px = 0.0;
  double shift_y_px = 0.0;
  double grow = 0.0;
  double turn = 0.0;  // rad, for small angles; clockwise in the picture

  friend bool operator==(const Similarity&, const Similarity&) = default;
};

struct SteadyCameraOptions {
  // Frames, evenly spaced (key frames where frames need others), in which is
  // looked whether the camera has moved. A vibration that is at rest in all of
  // them is missed. 6: by cost.
  int looks = 6;
  // Where frames need others and only the first can be read alone, the looks
  // are at so many frames from the first on.
  std::int64_t most_decoded = 100;
  // Places of the picture with a strong gradient that are compared: in these
  // looks, by cost, and in each frame of a camera that moves. More tell smaller
  // motions, by the root, and motion from rest in more parts of the picture:
  // with half of them one recording in 13 is less sure, with a quarter not
  // told.
  int points_looked_at = 1536;
  int points = 6144;

  // Displacement, px, from which the camera counts as moving, and standard
  // uncertainties that it must stand out of. Frames that are put back are
  // interpolated, which smooths their noise: below 0.1 px that is the greater
  // harm. Compression alone leaves some hundredths of a pixel.
  double least_moved_px = 0.1;
  double least_sigmas = 5.0;
  // Of the parts of the picture that tell motion from rest, the share that the
  // motion must explain better, and the same share of its left, middle and
  // right third; the largest displacement, as a share of the picture's smaller
  // side; and the share of the frames in which all that holds. Else it may be
  // the body that moves, and nothing is put back. Of 13 recordings and 140 of
  // the strangers' clips, those are put back whose scene moves as a plane: one,
  // filmed by hand.
  double least_support = 0.65;
  double least_support_of_third = 0.55;
  double most_moved = 0.15;
  double least_frames = 0.8;
};

struct CameraMotion {
  // From frame `first` to each frame from it on; empty where the camera stood
  // still, or what moved is not the camera alone.
  std::vector<Similarity> of;
  std::int64_t first = 0;
  // Where it is not empty: the farthest that any corner of the picture went,
  // px, and the u of a frame's place.
  std::optional<core::Estimate> most_moved_px;
  // Whether the scene moves in the left, the middle and the right third of the
  // picture, and a similarity explains it in some frames only: parallax of a
  // camera that is carried, or the skew of a rolling shutter.
  bool unexplained = false;
};

// The motion of the still scene in each frame of [first, last) against frame
// `first`: a similarity (shift, turn, scale), by robust least squares over
// points of strong gradient (Lucas and Kanade 1981, with Tukey's weights and a
// factor of the light). It is the recording's, in whatever channel or light its
// frames are looked at.
//
// One plane moves so: what lies nearer or farther than most of what stands
// still moves otherwise when the camera is shifted, not when it is turned.
//
// Throws what Clip::Read throws for frame `first`; a later frame that cannot be
// read keeps the place of the one before. std::invalid_argument if the range is
// empty or outside the clip.
CameraMotion MeasureCameraMotion(Clip& clip, std::int64_t first,
                                 std::int64_t last,
                                 const SteadyCameraOptions& options = {});

// The clip as a camera at rest would have shown it: frames put back by cubic
// interpolation (Keys 1981, a = -1/2), as 16-bit samples; places that a frame
// does not show have the levels of frame `first`. Coordinates are those of
// frame `first`. The clip itself where `motion` is empty. Throws what
// Clip::Read throws for frame `first`.
std::unique_ptr<Clip> PutBack(std::unique_ptr<Clip> clip,
                              const CameraMotion& motion);

}  // namespace touchdown::vision
