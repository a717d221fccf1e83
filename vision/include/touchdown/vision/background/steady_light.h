// A clip as it would be under steady light: lamps on mains flicker, and a
// background that breathes by a few per cent passes for a body everywhere.
#pragma once

#include <cstdint>
#include <memory>

#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

struct SteadyLightOptions {
  // How long is looked, from the first frame on, to tell whether the light
  // flickers: one period of lamps on 50 Hz mains. More costs time in compressed
  // clips, which are read from there again.
  double look_s = 0.010;
  // At least and at most so many frames, where that is too few to tell or too
  // many to wait for.
  int least_frames = 30;
  int most_frames = 100;
  // Points of the picture, on a grid, from which a frame's light is told. The
  // light is then known to noise / (level sqrt(points)): 2e-4 for 1 %.
  int points = 4096;
  // Standard deviation of the light, relative, from which it is taken out.
  // Where it varies by less, by exposure control or by what a large body
  // mirrors, the background's own noise estimate holds it, and correcting does
  // more harm than good (bouncing_cart: 0.6 %).
  double least_spread = 0.01;

  int threads = 0;  // 0: one for each core; affects speed only
};

struct SteadyLight {
  std::unique_ptr<Clip> clip;  // the one given, or one that corrects it
  double spread = 0.0;         // of the light, relative: standard deviation
  bool told = true;  // false: less than a quarter of the picture is below full
                     // scale, and the clip is the one given
  bool corrected = false;
};

// The light of a frame is one number g, its picture being g times that of
// steady light (all lamps flicker alike; black is 0): by least squares over the
// points, without those that a body hides. Where g varies by more than
// least_spread over the first frames of [first, last), the clip that comes back
// divides by it, as 16-bit samples; samples at full scale stay there. Throws
// what Clip::Read throws for frame `first`; a later frame that cannot be read
// ends the look. std::invalid_argument if the range is empty or outside the
// clip.
SteadyLight Deflicker(std::unique_ptr<Clip> clip, std::int64_t first,
                      std::int64_t last,
                      const SteadyLightOptions& options = {});

}  // namespace touchdown::vision
