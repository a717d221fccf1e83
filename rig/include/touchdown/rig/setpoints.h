// Set-points: the setting that gives a wanted contact, or why there is none.
//
// A rig has three knobs (compression, elevation, muzzle height), a contact two
// wishes (an angle and a speed). What is left free is chosen so that the
// contact depends least on what is hard to set:
//   approach  the height from which a level shot arrives at the wanted angle,
//             where the elevation drops out to first order; else the throw
//             nearest to level (downward where both signs are possible)
//   radius,   the elevation that gives the attitude at touchdown, and the
//   face      shortest flight, in which a residual spin acts least
// A muzzle keeps the body off the ground by three u of its height where it can.
//
// All throws that end in one contact are searched (throw_family.h in src/), so
// that what the rig can reach is not refused, whatever the spin.
#pragma once

#include <optional>
#include <random>
#include <vector>

#include "touchdown/core/expected.h"
#include "touchdown/core/words.h"
#include "touchdown/rig/description.h"
#include "touchdown/rig/predict.h"

namespace touchdown::rig {

struct ContactWish {
  core::AngleKind kind = core::AngleKind::kApproach;
  // approach and radius: 0 .. pi/2; face: -pi/2 .. pi/2, leading end up > 0.
  double angle_rad = 0.0;
  double speed_mps = 0.0;  // of the centre at touchdown, > 0
  // Rectangles: the corner that must land first. Kind radius without it: the
  // trailing corner (nose up, the paper's printed sign of friction) if
  // possible, else the leading one.
  std::optional<core::Corner> corner;
  std::optional<double> muzzle_height_m;  // held; else chosen as above
};

struct SetPoint {
  Setting setting;
  ContactPrediction contact;
};

// The setting alone, from the description's values. Absent with the reason, and
// where one exists the nearest cure: no such kind for this body, angle or speed
// out of reach of muzzle heights, elevations, compression, coil clearance or
// stress. Throws std::invalid_argument where the wish itself is out of range.
core::Expected<Setting> FindSetting(const Description& rig,
                                    const ContactWish& wish);

// The setting and the contact it predicts.
core::Expected<SetPoint> PlanContact(const Description& rig,
                                     const ContactWish& wish,
                                     const PredictOptions& options,
                                     std::mt19937_64& engine);

}  // namespace touchdown::rig
