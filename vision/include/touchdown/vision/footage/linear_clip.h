// A recording whose camera did not count light but a power of it.
//
//   level / full = light^gamma
//
// (IEC 61966-2-1 and ITU-R BT.709 are near 0.45.) Blur mixes light, not levels:
// in such pictures the middle of an edge lies tenths of a pixel on its dark
// side. A table turns levels back into light.
#pragma once

#include <cstdint>
#include <memory>

#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

// Levels of a recording, DN, and their light, DN of MakeLinear's clip.
struct LightScale {
  double full_level_dn = 255.0;
  double full_light_dn = 4095.0;
  double gamma = 1.0;

  // Black is taken for level 0; what lies below is black.
  double ToLight(double level_dn) const;
  double ToLevel(double light_dn) const;
};

// 12 bits of 8, 16 of more: what is lost to rounding is below the camera's own.
// `gamma`: above 0.
LightScale MakeLightScale(std::int32_t bit_depth, double gamma);

// The clip in light. Of a gamma of 1 its levels as they are, known to be light.
std::unique_ptr<Clip> MakeLinear(std::unique_ptr<Clip> clip, double gamma);

// The same of a clip that must outlive the view.
std::unique_ptr<Clip> ViewInLight(Clip& clip, double gamma);

}  // namespace touchdown::vision
