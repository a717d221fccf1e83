// What outlines that lie beside the body make of its place.
#pragma once

#include <numbers>

namespace touchdown::vision {

// Standard uncertainty of the place, px, of a body whose outline lies
// `beside_px` beside it: the place is off by between nothing, where all edges
// err alike, and that, where one edge errs alone; evenly spread.
inline double PlaceUncertaintyBeside(double beside_px) {
  return beside_px / std::numbers::sqrt3;
}

}  // namespace touchdown::vision
