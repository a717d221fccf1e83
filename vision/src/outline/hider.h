// What stands before the body: a post, the ejector's muzzle, a frame's rim.
//
// A thing at rest is part of the still picture. Where the body should be seen
// and the picture stays as it is, frame after frame, something hides it; these
// pixels tell nothing of the body. A frame in which it hides little looks whole
// by itself, and its edge is then taken for the body's: that the place is the
// same in all frames is what shows it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "outline/outline_batch.h"
#include "touchdown/core/points.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

struct Hider {
  core::PixelRect box;              // in the picture
  std::vector<std::uint8_t> hides;  // of its pixels, row by row; not 0: hidden

  bool Hides(double x_px, double y_px) const;
};

struct HiderOptions {
  double body_dn = 0.0;  // level of the body
  double blur_px = 0.8;
  double open = 0.0;  // share of the frame interval that is exposed
};

// From where the body should be seen (`jobs`: frame, outline, motion), and a
// fifth of it is: pixels clear inside the outline in at least two frames that
// on the mean show less than a quarter of the way from the still picture to the
// body's level, and all within the reach of their blurred edge. Nothing where
// they are fewer than a hundredth of the body, or where the levels are nowhere
// four times the noise apart. Reads the clip.
std::shared_ptr<const Hider> FindHider(Clip& clip, const Background& background,
                                       std::span<const OutlineJob> jobs,
                                       const HiderOptions& options);

// The outline and its motion in a frame where it was not measured, on the
// flight (steady along the ground, a parabola across it) through up to 24 of
// the `fits` (by frame) that are the nearest; nothing where fewer than six are
// within 0.7 px of one flight, or where they lie farther away than they span,
// twice.
std::optional<OutlineJob> Predict(std::span<const Fitted> fits,
                                  std::int64_t frame, double ground_angle_rad);

}  // namespace touchdown::vision
