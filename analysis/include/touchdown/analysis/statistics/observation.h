// Trials as the statistics see them: one angle with its uncertainty, one
// answer.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "touchdown/core/trial.h"

namespace touchdown::analysis {

// The paper's two words, and the third that honesty needs.
enum class Outcome { kNotBounce, kBounce, kUndecided };

// One trial. The angle is the trial's contact angle (of whatever one kind the
// group has; a face angle enters by its magnitude).
struct Observation {
  double angle_rad = 0.0;
  // Standard uncertainty of angle_rad, >= 0: the trial's own part of it, which
  // differs from trial to trial.
  double u_rad = 0.0;
  // The part that all trials of a set-up have in common (level, yaw, lens,
  // scale): one error, of this standard uncertainty, moves them together.
  double common_u_rad = 0.0;
  int setup = 0;  // which trials these are: equal numbers, one set-up
  // P(the body bounced | what was filmed): near 1 or 0 for decided trials.
  double p_bounce = 0.5;
  Outcome outcome = Outcome::kUndecided;
  std::optional<double> set_angle_rad;  // set-point, where there was one
  std::size_t trial = 0;                // index in the span it was made from
};

// Own and common part together.
double TotalU(const Observation& observation);

// A state is decided where the 95 % interval of the greatest gap lies on one
// side of the bounce height, so a bare probability decides from 0.975 on.
inline constexpr double kDecidedProbability = 0.975;

// An observation from bare numbers (a CSV line). The outcome follows from
// `p_bounce` by kDecidedProbability. Throws std::invalid_argument unless
// 0 <= angle <= pi/2, 0 <= u and 0 <= p_bounce <= 1, all finite.
Observation Observe(double angle_rad, double u_rad, double p_bounce);

// A trial that cannot enter the statistics, and why.
struct LeftOut {
  std::size_t trial = 0;
  std::string reason;
};

// Trials that may be pooled: one campaign, one kind of body, one kind of angle,
// one origin. Nothing in this module takes trials of more than one group.
struct TrialGroup {
  std::string campaign;
  core::BodyKind body = core::BodyKind::kSphere;
  core::AngleKind angle_kind = core::AngleKind::kApproach;
  core::Origin origin = core::Origin::kRecorded;
  std::vector<Observation> observations;  // by angle, then by index
  std::vector<LeftOut> left_out;          // by index
};

// Splits trials into groups, in the order of (campaign, body, kind of angle,
// origin). A trial is left out, with the reason, where it is excluded, where
// its contact angle is absent, or where it is undecided without a P(bounce)
// from 0.025 to 0.975: its rebound was not filmed to its top, so that it says
// nothing of the boundary. A decided state keeps its P(bounce) where that says
// the same as the label, else it becomes 1 or 0.
std::vector<TrialGroup> GroupTrials(std::span<const core::Trial> trials);

}  // namespace touchdown::analysis
