// Where a body of known shape is in two pictures, from what differs between
// them alone.
//
// A body that goes less than its own length is before itself: two strips
// differ, the one that it left and the one that it came to, and the shape
// covers either of them in many places. Both places together cover what differs
// once, and what does not differ twice or not at all:
//   (p, q) = argmin sum |E - (M_p xor M_q)|
// with M the shape's cover and E the change (still_layer.h). Which place is
// whose E does not tell.
#pragma once

#include <optional>
#include <utility>

#include "detection/path_search.h"

namespace touchdown::vision {

// `two`: two pictures. Absent where nothing differs, or in one place only.
std::optional<std::pair<PlacedShape, PlacedShape>> FindPairOfPlaces(
    const PathSearch& in, const ReducedFrames& two);

}  // namespace touchdown::vision
