// The shape of a body of unknown size, from what changes along its path.
//
// In the body's own coordinates the mean change is near 1 where the body is:
//   V(l) = mean over pictures of E(x(l)) - 1/2
// (E of still_layer.h: 1/2 where the still layer is not known). The rectangle,
// or the disc, of the largest sum of V leaves the least change unexplained
// (MeasureUnexplained) of all on these poses. It may begin as a part of the
// body that moves as the whole does.
#pragma once

#include <optional>

#include "detection/path_search.h"

namespace touchdown::vision {

// Up to twice as large as that of the search, `in.shape`, whose path is `path`;
// cells. Absent where nothing of it differs.
std::optional<KnownShape> FitShapeAlongPath(const PathSearch& in,
                                            const FoundPath& path);

}  // namespace touchdown::vision
