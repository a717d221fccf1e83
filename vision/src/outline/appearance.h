// What a body looks like beyond a smooth shading: highlights and other bright
// or dark spots, learnt from many frames.
//
// In each frame the level inside, clear of the blurred edge, is
//   in(p) = out(p) + (I(p) - out(p)) / c(p)
// (outline.h). What its shading does not say, of all frames together, is
// described by spots (spots.h): a lamp mirrored by a curved or rough face is
// one, and what is known of it clear inside the body tells what it adds at the
// edge. A map of any shape would have to be seen at the edge to do so, where
// it takes an outline's error for a look of the body (tried: radii were off by
// ten times what they claimed). The quadratic under the spots is found again by
// each frame's own shading, and dropped; of a body too small for a shading of
// its own the slope is kept.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "outline/spots.h"
#include "touchdown/core/points.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/outline/outline.h"

namespace touchdown::vision {

// Axes are those of the image (a highlight stays where the lamp is) or of the
// body (a patch turns with it), from the body's centre.
struct Appearance {
  struct Value {
    double level_dn = 0.0;  // to be added to the shading
    double u_dn = 0.0;      // its standard uncertainty
  };
  // At (x, y) px from the body's centre along the image's axes. `cosine`,
  // `sine`: of the body's angle.
  Value At(double x_px, double y_px, double cosine, double sine) const;

  bool turns = false;  // the axes are the body's
  bool shaded = true;  // its fits have a shading of their own
  SpotModel spots;
};

// A frame whose outline is known.
struct SeenOutline {
  std::int64_t frame = 0;
  OutlineFit fit;
  core::PixelPoint travel_px{0.0, 0.0};  // as in OutlineOptions
  double turn_rad = 0.0;                 //
};

// Learns it from these frames (or 40 of them), read from `clip`. `options`:
// those of the fits. Nothing where fewer than 8 frames, or too few pixels clear
// of the edge, show the body, and where it is shaded as its fits say. Throws
// what Clip::Read throws.
std::optional<Appearance> LearnAppearance(Clip& clip,
                                          const Background& background,
                                          std::span<const SeenOutline> frames,
                                          const OutlineOptions& options);

}  // namespace touchdown::vision
