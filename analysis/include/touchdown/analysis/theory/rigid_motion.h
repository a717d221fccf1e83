// Where a rigid sphere or rectangle goes when it is thrown at flat, rough
// ground: the exact truth behind simulated footage.
//
// The motion is a chain of stretches whose accelerations are constant, joined
// by events; there is no integrator and so no integration error:
//   flight    x'' = 0, y'' = -g, spin constant. The first contact is the first
//             root of a corner's height (sphere: of y - R), by conservative
//             advancement: with |h''| <= M = g + r w^2 no root lies within
//             tau = (h' + sqrt(h'^2 + 2 M h)) / M, so that none is skipped;
//             for w = 0 the first step is the closed form.
//   impact    Routh/Poisson, impact.h. A flush landing hits both corners at
//             once: y' -> -e y', the friction impulse is the smaller of
//             mu (1 + e) |y'| and what stops the sliding, no spin
//             (reference: rigid block, both normal impulses positive, mu H <
//             L).
//   sliding   sphere: x'' = -sign(u) mu g, w' = x'' R / k^2 until the contact
//             point's velocity u = x' + w R is 0; then it rolls on.
//             rectangle, flush: x'' = -sign(x') mu g until it rests.
//
// Bounces end by one rule: a rebound slower than `rest_speed_mps` is none. The
// sphere and the flush rectangle then stay on the ground. A rectangle that
// stays on one corner while it tilts has no closed form: it hops on that
// corner, each rebound at least as fast as rest_speed, 2 nm high at the default
// 0.2 mm/s; the mean force is that of the sustained contact. Near flush (both
// corners within 10 times the hops' speed) it is laid down. Energy never grows
// but for what a hop may need to be rest_speed fast, rest_speed^2 / 2 per mass.
//
// Air and rolling resistance are left out. The ground is y = 0, x points in
// the direction of travel, angles and spins are counter-clockwise.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "touchdown/core/body.h"
#include "touchdown/core/points.h"
#include "touchdown/core/units.h"
#include "touchdown/core/words.h"

namespace touchdown::analysis {

struct BodyState {
  double time_s = 0.0;
  core::PlanePoint centre;
  double angle_rad = 0.0;  // of a rectangle's long side
  double vx_mps = 0.0;
  double vy_mps = 0.0;
  double omega_rad_per_s = 0.0;
};

struct RigidMotionProblem {
  core::Body body;  // sizes present; u is not used
  // Radius of gyration; 0: of the homogeneous body, sqrt(2/5) R of a sphere,
  // sqrt((a^2 + b^2) / 12) of a rectangle.
  double gyration_radius_m = 0.0;
  double mu = 0.0;                                    // >= 0
  double restitution = 0.0;                           // 0..1, Poisson's
  double gravity_mps2 = core::kStandardGravity_mps2;  // > 0
  BodyState start;                                    // on or above the ground
  double end_s = 1.0;                                 // > start.time_s
  double rest_speed_mps = 2e-4;                       // > 0; see above
  std::size_t max_stretches = 1000000;
};

enum class StretchKind { kFlight, kSlide, kRoll, kRest };

// From start.time_s to the start of the next stretch.
struct Stretch {
  StretchKind kind = StretchKind::kFlight;
  BodyState start;
  double ax_mps2 = 0.0;
  double ay_mps2 = 0.0;
  double angular_acceleration_rad_per_s2 = 0.0;
};

enum class EventKind {
  kImpact,       // one point strikes the ground
  kFlushImpact,  // two corners at once
  kSettles,      // stays on the ground from here: slides
  kRolls,        // sphere: sliding has stopped
  kRests         // rectangle: sliding has stopped
};

struct MotionEvent {
  EventKind kind = EventKind::kImpact;
  BodyState before;
  BodyState after;
  // Contact point (middle of the side in a flush impact) from the centre, and
  // its velocity.
  double offset_x_m = 0.0;
  double offset_y_m = 0.0;
  double contact_vx_before_mps = 0.0;
  double contact_vy_before_mps = 0.0;
  double contact_vx_after_mps = 0.0;
  double contact_vy_after_mps = 0.0;
};

struct RigidMotion {
  core::Body body;
  double gyration_radius_m = 0.0;
  double end_s = 0.0;
  std::vector<Stretch> stretches;   // at least one
  std::vector<MotionEvent> events;  // hops are not listed
  bool complete = true;             // false: max_stretches reached before end_s
};

// Throws std::invalid_argument for an argument outside its range.
RigidMotion SimulateRigidMotion(const RigidMotionProblem& problem);

// State at any time; before the first and beyond the last stretch these two
// are continued.
BodyState ComputeState(const RigidMotion& motion, double time_s);

// Height of the lowest outline point.
double ComputeGap(const RigidMotion& motion, double time_s);

// The greatest gap within [from_s, to_s] and when, to 1e-9 m.
struct GreatestGap {
  double gap_m = 0.0;
  double time_s = 0.0;
};
GreatestGap ComputeGreatestGap(const RigidMotion& motion, double from_s,
                               double to_s);

// The first touchdown, with the exact angles of words.h. Nothing if the body
// never touches the ground; from_start if it is on it from the beginning.
struct TouchdownTruth {
  double time_s = 0.0;
  bool from_start = false;
  double approach_angle_rad = 0.0;
  std::optional<double> radius_angle_rad;  // rectangle only
  std::optional<double> face_angle_rad;    // rectangle only, in (-pi/2, pi/2]
  std::optional<core::Corner> corner;      // rectangle only
  BodyState before;
  BodyState after;
  double contact_vx_before_mps = 0.0;
  double contact_vy_before_mps = 0.0;
  double contact_vx_after_mps = 0.0;
  double contact_vy_after_mps = 0.0;
};
std::optional<TouchdownTruth> FirstTouchdown(const RigidMotion& motion);

}  // namespace touchdown::analysis
