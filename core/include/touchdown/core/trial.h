// A trial and its parts: what vision measures, the store keeps, analysis
// compares and the report prints.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "touchdown/core/body.h"
#include "touchdown/core/conditions.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/words.h"

namespace touchdown::core {

// Touchdown: the first instant at which the gap (height of the body's lowest
// outline point above the ground line) reaches zero.
struct Contact {
  bool found = false;
  std::string reason;  // why not found; empty when found

  // The body was on the ground from the first frame: contact "from the start",
  // approach angle 0; no time of touchdown then.
  bool from_start = false;

  Measured time_s = AbsentBecause("no contact");
  Measured frame = AbsentBecause("no contact");  // same instant, in frames
  Measured approach_angle_rad = AbsentBecause("no contact");
  Measured radius_angle_rad = AbsentBecause("no contact");
  Measured face_angle_rad = AbsentBecause("no contact");
  std::optional<Corner> corner;                       // nothing for a sphere
  Measured duration_s = AbsentBecause("no contact");  // touchdown to release
  Budget approach_budget;  // of approach_angle_rad, in radians
  Budget attitude_budget;  // of radius and face angle, in radians

  friend bool operator==(const Contact&, const Contact&) = default;
};

// The angle of `contact` that `kind` names.
inline const Measured& Angle(const Contact& contact, AngleKind kind) {
  switch (kind) {
    case AngleKind::kRadius:
      return contact.radius_angle_rad;
    case AngleKind::kFace:
      return contact.face_angle_rad;
    case AngleKind::kApproach:
      break;
  }
  return contact.approach_angle_rad;
}
inline Measured& Angle(Contact& contact, AngleKind kind) {
  const Contact& same = contact;
  return const_cast<Measured&>(Angle(same, kind));
}

// The motion state by the one rule of words.h, with its evidence.
struct StateDecision {
  MotionState label = MotionState::kUndecided;
  std::optional<double> p_bounce;  // nothing where `reason` says why not
  std::string reason;
  Measured max_gap_m = AbsentBecause("no contact");
  Measured bounce_height_m = AbsentBecause("no scale");  // u = 0: convention
  Measured detectable_gap_m = AbsentBecause("no contact");
  // Where the film ends while the body rises and the gap filmed so far is below
  // the bounce height: the greatest gap that this flight would reach. The state
  // is then undecided, without a P(bounce). Absent for every other trial.
  Measured extrapolated_gap_m =
      AbsentBecause("no flight was cut off by the end of the film");
  bool micro_bounce = false;  // left the ground without reaching bounce height

  friend bool operator==(const StateDecision&, const StateDecision&) = default;
};

// Velocities in the plane frame, of the centre unless said otherwise. `omega`
// is positive counter-clockwise in the plane frame (x in the direction of
// travel).
struct Motion {
  Measured before_speed_mps = AbsentBecause("no contact");
  Measured before_normal_mps = AbsentBecause("no contact");  // < 0: downward
  Measured before_tangential_mps = AbsentBecause("no contact");
  Measured before_omega_rad_per_s = AbsentBecause("no contact");
  Measured after_normal_mps = AbsentBecause("no contact");
  Measured after_tangential_mps = AbsentBecause("no contact");
  Measured after_omega_rad_per_s = AbsentBecause("no contact");
  // -(normal velocity of the contact point at release) / (at touchdown).
  // Of a rectangle that struck with one corner and then the other before the
  // next frame, absent: the impacts were not resolved, at least so many.
  Measured restitution = AbsentBecause("no contact");
  int unresolved_impacts = 0;  // not a column of the store; in its document
  // The same quotient of the centre's velocities: another number.
  Measured centre_rebound_ratio = AbsentBecause("no contact");
  // |change of tangential| / |change of normal velocity| of the centre.
  Measured impulse_ratio = AbsentBecause("no contact");
  // Gravity fitted freely, a check of scale and frame rate; present only where
  // its u is below 10 % of the gravity that is known.
  Measured gravity_check_mps2 = AbsentBecause("no contact");

  friend bool operator==(const Motion&, const Motion&) = default;
};

// One touchdown with what followed it.
struct ContactRecord {
  Contact contact;
  StateDecision state;
  Motion motion;

  friend bool operator==(const ContactRecord&, const ContactRecord&) = default;
};

// How a clip is known.
struct ClipIdentity {
  std::string path;    // where it was last seen
  std::string id;      // cheap digest of size, header and spaced blocks
  std::string sha256;  // of the whole; empty where not computed
  std::int64_t size_bytes = 0;

  friend bool operator==(const ClipIdentity&, const ClipIdentity&) = default;
};

// One statement about one shot. A re-analysis or a human correction is a new
// revision of the same trial; nothing is overwritten.
struct Trial {
  std::string id;        // UUID, given by the store
  std::string campaign;  // name; empty: none
  Origin origin = Origin::kRecorded;
  ClipIdentity clip;  // path empty for manual trials
  Body body;
  AngleKind angle_kind = AngleKind::kApproach;  // of the contact angle
  ContactRecord first;
  std::vector<ContactRecord> later;

  std::optional<double> set_angle_rad;  // set-point of the varied angle
  std::optional<double> set_speed_mps;  // set-point of the launch speed

  std::optional<Conditions> conditions;  // nothing: none were ever stated

  std::int64_t revision = 0;     // 1 for the first, given by the store
  std::string author;            // program or person who states this
  std::string reason;            // why this revision was made
  std::string recorded_at_utc;   // ISO 8601, given by the store
  std::string software_version;  //
  std::string options_hash;      // digest of the options of the analysis
  std::string document_json;     // the whole touchdown.analysis document
  bool excluded = false;
  std::string exclusion_reason;
};

// The contact angle that a protocol names by `kind`: of kind face the magnitude
// of the face angle, which itself is positive with the leading end up.
inline Measured ContactAngle(const Contact& contact, AngleKind kind) {
  Measured angle = Angle(contact, kind);
  if (kind != AngleKind::kFace || !angle || angle->value >= 0.0) return angle;
  angle->value = -angle->value;
  if (const auto interval = angle->interval95) {
    angle->interval95 = Interval{-interval->high, -interval->low};
  }
  return angle;
}
inline Measured ContactAngle(const Trial& trial) {
  return ContactAngle(trial.first.contact, trial.angle_kind);
}

}  // namespace touchdown::core
