// From the compressed springs to the muzzle: Eq. (10) of the paper, and the
// energy balance that it abbreviates.
//
//   v = X sqrt(H/m)                                                  (10)
//
//   (m + m_s/3) v^2 = eta H ((X0+X)^2 - X0^2)      springs, less their losses
//                     - 2 (m + m_s/2) g X sin(theta)   lifting body and springs
//                     - 2 mu_b m g X cos(theta)        friction along the
//                     barrel
//                     - 2 E_loss                       per shot, e.g. the latch
//
// The spring's own mass m_s enters with m_s/3 (Rayleigh: velocities linear
// along the coil) and is lifted by half the travel. The right side is concave
// in X and 0 at X = 0 (without E_loss), so a body that reaches the muzzle with
// v > 0 was nowhere stopped on the way.
//
// The springs push over the travel X and are still compressed by the preload X0
// when the body leaves.
#pragma once

#include <numbers>
#include <vector>

#include "touchdown/core/expected.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/finding.h"

namespace touchdown::rig {

// Eq. (10): no preload, gravity, friction, losses or spring mass. X >= 0 in m,
// H > 0 in N/m (all springs together), m > 0 in kg; throws
// std::invalid_argument otherwise.
double IdealLaunchSpeed(double compression_m, double stiffness_n_per_m,
                        double mass_kg);

struct Launch {
  double stiffness_n_per_m = 0.0;  // H, all springs together; > 0
  double mass_kg = 0.0;            // m, of the body (and of a sled); > 0
  double spring_mass_kg = 0.0;     // m_s, all springs together; >= 0
  double preload_m = 0.0;          // X0 >= 0
  double elevation_rad = 0.0;      // theta, barrel above horizontal; +-pi/2
  double efficiency = 1.0;         // eta > 0, share of the springs' energy
  double barrel_friction = 0.0;    // mu_b >= 0
  double loss_j = 0.0;             // E_loss >= 0
  double gravity_mps2 = core::kStandardGravity_mps2;  // >= 0
};

// Where the energy goes, J. spring = losses + gravity + friction + body +
// spring_motion; gravity < 0 where the barrel points down.
struct EnergyBalance {
  double spring_j = 0.0;  // H ((X0+X)^2 - X0^2) / 2, before losses
  double losses_j = 0.0;  // (1 - eta) of it, and E_loss
  double gravity_j = 0.0;
  double friction_j = 0.0;
  double body_j = 0.0;           // m v^2 / 2
  double spring_motion_j = 0.0;  // m_s v^2 / 6
};

struct Muzzle {
  double speed_mps = 0.0;
  EnergyBalance energy;

  // Sum of the magnitudes of the energy terms over what is left of them; the
  // factor by which relative errors of the terms grow in v^2. 1 without losses.
  double cancellation = 1.0;
  std::vector<Finding> findings;
};

// A difference this many times smaller than its terms gets a warning: 1 % in
// the stiffness is then more than 5 % in the speed.
inline constexpr double kCancellationWarning = 10.0;

// The balance solved for v at compression X >= 0. Absent, with the balance in
// the reason, where the body does not leave the muzzle (no energy left, or X =
// 0). Throws std::invalid_argument where a field is outside its range.
core::Expected<Muzzle> LaunchSpeed(const Launch& launch, double compression_m);

// The balance solved for X: the compression with which the body leaves at
// `speed_mps` >= 0. The answer exists always (whether the springs bear it:
// CheckSpring); stable where gravity nearly cancels the preload. Throws as
// above.
double SolveCompression(const Launch& launch, double speed_mps);

}  // namespace touchdown::rig
