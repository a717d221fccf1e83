// What ugly footage has and a careful set-up avoids. Everything here is drawn
// over the plain picture of render.h with its own blur, to about 1e-3 of the
// contrast where it overlaps an edge: enough to ask what it does to a
// measurement.
#pragma once

#include <cstdint>
#include <optional>

#include "touchdown/core/points.h"

namespace touchdown::vision {

struct SceneTrouble {
  // The body's own shading: its level is multiplied by 1 + sx xi + sy eta, with
  // xi to the right and eta downwards in the picture from the body's centre, in
  // units of half its greatest size.
  double shading_x = 0.0;
  double shading_y = 0.0;
  // A bright spot where the body mirrors the lamp: Gaussian, this high (of full
  // scale), at this place and of this standard deviation in units of half the
  // body's smallest size. It stays where it is while the body turns.
  double highlight_level = 0.0;
  double highlight_x = -0.35;
  double highlight_y = -0.40;
  double highlight_sigma = 0.20;
  // Under a lamp above: the ground below the body is darker by this share where
  // they touch; wider and paler the higher the body is.
  double shadow_depth = 0.0;
  // Mains: all light is multiplied by 1 + a sin(2 pi f t).
  double flicker_amplitude = 0.0;
  double flicker_hz = 100.0;
  // The ground's visible edge: this high above and below its line.
  double wave_amplitude_px = 0.0;
  double wave_length_px = 40.0;
  // Other things that move, behind the body and of its brightness: discs on
  // straight ways, seen again on the other side when they have left.
  std::int32_t specks = 0;
  double speck_diameter_px = 3.0;
  double speck_speed_px = 2.0;  // a frame
  std::uint64_t speck_seed = 1;
  // Something that stands in front of the body, such as the ejector's frame.
  std::optional<core::PixelRect> obstacle;
  double obstacle_level = 0.1;
};

bool HasTrouble(const SceneTrouble& trouble);

}  // namespace touchdown::vision
