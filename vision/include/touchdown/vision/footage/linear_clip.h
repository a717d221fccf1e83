// A recording whose camera did not count light but a power of it.
//
//   level / full = light^gamma
//
// (IEC 61966-2-1 and ITU-R BT.709 are near 0.45.) Blur mixes light, not levels:
// in such pictures the middle of an edge lies tenths of a pixel on its dark
// side. A table turns levels back into light.
#pragma once

#include <memory>

#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

// 12 bits of 8, 16 of more: what is lost to rounding is below the camera's own.
// Black is taken for level 0. `gamma`: above 0.
std::unique_ptr<Clip> MakeLinear(std::unique_ptr<Clip> clip, double gamma);

}  // namespace touchdown::vision
