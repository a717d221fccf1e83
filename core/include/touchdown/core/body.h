// The body: what was thrown, and how large it is.
#pragma once

#include <string>

#include "touchdown/core/estimate.h"
#include "touchdown/core/words.h"

namespace touchdown::core {

// A sphere has `diameter_m`; a rectangle has `long_m` >= `short_m`, both in the
// image plane. A size nobody gave or measured is absent with its reason.
struct Body {
  BodyKind kind = BodyKind::kSphere;
  Measured diameter_m = AbsentBecause("not a sphere");
  Measured long_m = AbsentBecause("not a rectangle");
  Measured short_m = AbsentBecause("not a rectangle");

  friend bool operator==(const Body&, const Body&) = default;
};

// A sphere of known diameter. Throws std::invalid_argument unless
// diameter > 0 and finite and u >= 0.
Body Sphere(Estimate diameter_m);

// A rectangle of known sides, in either order. Throws like Sphere.
Body Rectangle(Estimate side_a_m, Estimate side_b_m);

// A body whose size nobody gave or measured: the sizes of its kind are absent
// for this reason, the others because it has none.
Body UnmeasuredBody(BodyKind kind, const std::string& reason = "not recorded");

// The body's size, the length that conventions refer to: the diameter, or the
// long side.
Measured Size(const Body& body);

// The default bounce height of a campaign: the larger of 0.5 mm and 2 % of the
// body's size, in metres. `size_m` > 0.
double DefaultBounceHeight(double size_m);

// The kind of angle a protocol names when nobody says otherwise: approach for
// spheres, radius for rectangles.
AngleKind DefaultAngleKind(BodyKind kind);

}  // namespace touchdown::core
