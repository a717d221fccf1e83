// Impact of one point of a rigid body on the ground, with friction and
// restitution: the states before and after, marched in impulse.
//
// With P the normal impulse so far divided by the mass (m/s) and r the ratio of
// tangential to normal impulse (@cite Routh1905; Poisson's restitution; the
// frame is that of corner.h):
//   d v_N / dP = G_NN + G_NT r        d v_T / dP = G_NT + G_TT r
//   r = -slip mu          while P slides;
//   r = -G_NT / G_TT      when slip has stopped, if |G_NT / G_TT| <= mu
//   (sticks); r = sign(G_NT) (-mu)  otherwise (slips back).
// Compression ends at v_N = 0 with impulse P_c, restitution at (1 + e) P_c.
// The spin changes by d(alpha)/dt += -(kappa/R)(cos P + sin T).
//
// Impact without collision. A sliding contact may be inconsistent: no finite
// force keeps v_N = 0 (contact.h, Regime::kInconsistent; Painleve's paradox).
// Then the same marching starts at v_N = 0: friction drives P into the ground
// until the slip stops, after impulse v_T / (mu G_TT - G_NT), then it sticks
// and is pushed out. It always ends (@cite Champneys2016, @cite Hogan2017).
//
// A true sphere is the special case alpha = 90 deg, contact below the centre:
// G_NN = 1, G_NT = 0, G_TT = 1 + kappa; its bounce depends on neither spin nor
// friction. Valid for a point contact of a rigid body; not for a flush landing
// (flat_contact.h).
#pragma once

#include <array>
#include <span>

#include "touchdown/analysis/theory/corner.h"

namespace touchdown::analysis {

// State just before, in the frame of corner.h (P at +x of C; cos < 0 is allowed
// and lays P behind C).
struct ImpactProblem {
  SinCos alpha;
  double radius_m = 0.0;              // R, > 0
  double kappa = 3.0;                 // R^2/k^2, >= 0
  double mu = 0.0;                    // >= 0
  double restitution = 0.0;           // e, Poisson's ratio of impulses, 0..1
  double tangential_mps = 0.0;        // v_T of P
  double normal_mps = 0.0;            // v_N of P; < 0 towards the ground
  double alpha_rate_rad_per_s = 0.0;  // d(alpha)/dt, clockwise
};

enum class ImpactStatus {
  kNone,             // v_N >= 0 and no inconsistent slip: nothing happens
  kCollision,        // v_N < 0
  kWithoutCollision  // v_N = 0 and A_hat <= 0 in the direction of slip
};

// A stretch of the impact with one ratio r; slip kNone means it sticks.
struct ImpactPhase {
  Slip slip = Slip::kNone;
  bool compression = true;
  double normal_impulse_mps = 0.0;  // per unit mass, of this stretch
};

// Impulses are per unit mass (N s/kg = m/s) and so equal the changes of the
// centre's velocity along x and y.
struct ImpactResult {
  ImpactStatus status = ImpactStatus::kNone;
  double tangential_mps = 0.0;        // v_T of P after
  double normal_mps = 0.0;            // v_N of P after
  double alpha_rate_rad_per_s = 0.0;  // after
  double compression_impulse_mps = 0.0;
  double normal_impulse_mps = 0.0;
  double tangential_impulse_mps = 0.0;
  std::array<ImpactPhase, 4> phase{};
  int n_phases = 0;

  std::span<const ImpactPhase> Phases() const {
    return {phase.data(), static_cast<std::size_t>(n_phases)};
  }
};

// Throws std::invalid_argument for an argument outside its range. Allocates
// nothing.
ImpactResult Impact(const ImpactProblem& problem);

// The same in the plane frame, for simulators: contact point at `offset` from
// the centre, velocities of the centre, spin counter-clockwise.
struct BodyImpact {
  double offset_x_m = 0.0;
  double offset_y_m = 0.0;         // not both 0
  double gyration_radius_m = 0.0;  // k, > 0
  double mu = 0.0;
  double restitution = 0.0;
  double velocity_x_mps = 0.0;
  double velocity_y_mps = 0.0;
  double omega_rad_per_s = 0.0;
};

struct BodyImpactResult {
  double velocity_x_mps = 0.0;
  double velocity_y_mps = 0.0;
  double omega_rad_per_s = 0.0;
  ImpactResult impact;  // of the contact point
};

BodyImpactResult ImpactOfBody(const BodyImpact& body);

}  // namespace touchdown::analysis
