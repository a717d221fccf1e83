// All throws that end in one contact: a family with one parameter, the time of
// flight.
//
// A contact has a speed V and either an approach angle beta or an attitude phi
// (of the long side, of which half turns are the same). Played backwards for a
// time t from the touchdown, the throw is explicit:
//   approach  tan(theta) = (g t - V sin beta) / (V cos beta)
//   attitude  theta = phi + k pi - seat - omega t, and
//             V sin(beta + theta) = g t cos(theta): two beta
//   both      h = D(phi) + V sin(beta) t - g t^2 / 2
//             v^2 = V^2 cos^2(beta) + (g t - V sin beta)^2
// with D the height of the centre at touchdown. No equation is solved, so that
// none can fail to converge, and a search over t misses no throw.
#pragma once

#include <optional>
#include <vector>

#include "touchdown/core/expected.h"
#include "touchdown/core/words.h"
#include "touchdown/rig/description.h"
#include "touchdown/rig/setpoints.h"

namespace touchdown::rig {

struct Throw {
  double time_s = 0.0;
  double elevation_rad = 0.0;
  double muzzle_height_m = 0.0;
  double launch_speed_mps = 0.0;
  double centre_height_m = 0.0;  // at touchdown
  double face_rad = 0.0;         // at touchdown, turns counted
};

// One stretch of the time of flight in which the throw varies smoothly.
struct ThrowFamily {
  core::AngleKind kind = core::AngleKind::kApproach;
  double angle_rad = 0.0;  // beta, or phi + k pi
  bool steep = false;      // attitudes: beta + theta beyond a quarter turn
  double speed_mps = 0.0;  // V
  double from_s = 0.0;
  double to_s = 0.0;
  int cells = 0;  // of the search: none holds two turns of the body
};

// The throw that flies for `time_s` > 0; nothing where the contact cannot be
// at the end of such a flight.
std::optional<Throw> ComputeThrow(const Description& rig,
                                  const ThrowFamily& family, double time_s);

// The families of a wanted approach angle (one), or of a wanted attitude (one
// for each half turn that the spin can make, and each of the two beta).
std::vector<ThrowFamily> ApproachFamilies(const Description& rig,
                                          const ContactWish& wish);
std::vector<ThrowFamily> AttitudeFamilies(const Description& rig,
                                          const ContactWish& wish,
                                          double face_rad);

// Of a family's throws the one that the rig can do and that is to be preferred
// (setpoints.h), with its compression; else the reason why there is none: of
// elevation, height, corner, springs and a free way to the ground, taken in
// this order, the first that no throw satisfies along with those before.
core::Expected<Setting> BestThrow(const Description& rig,
                                  const ContactWish& wish,
                                  const std::vector<ThrowFamily>& families);

}  // namespace touchdown::rig
