#include "touchdown/analysis/statistics/observation.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <compare>
#include <map>
#include <numbers>
#include <stdexcept>
#include <tuple>

#include "touchdown/core/require.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {
namespace {

Outcome DecideOutcome(double p_bounce) {
  if (p_bounce >= kDecidedProbability) return Outcome::kBounce;
  if (p_bounce <= 1.0 - kDecidedProbability) return Outcome::kNotBounce;
  return Outcome::kUndecided;
}

// What was measured where it says the same as the label; a label corrected by
// hand may stand beside the old probability, and then counts alone.
double DecidedProbability(const core::StateDecision& state, bool bounced) {
  const double p = state.p_bounce.value_or(bounced ? 1.0 : 0.0);
  const bool same =
      bounced ? p >= kDecidedProbability : p <= 1.0 - kDecidedProbability;
  return same ? std::clamp(p, 0.0, 1.0) : bounced ? 1.0 : 0.0;
}

// What an undecided trial says of the boundary. A label corrected by hand, or a
// film that ends before the top of the rebound, may stand beside a probability
// that decides; the label counts, and then the trial says nothing.
std::optional<double> UndecidedProbability(const core::StateDecision& state) {
  if (!state.p_bounce) return std::nullopt;
  const double p = std::clamp(*state.p_bounce, 0.0, 1.0);
  if (DecideOutcome(p) != Outcome::kUndecided) return std::nullopt;
  return p;
}

// Why an undecided trial has no P(bounce), with what its flight would reach:
// that height presumes an undisturbed flight, for which the statistics have no
// model, so that it is told and not used.
std::string WhyNoProbability(const core::StateDecision& state) {
  std::string why = "undecided, without a P(bounce)";
  if (!state.reason.empty()) why += ": " + state.reason;
  if (state.extrapolated_gap_m) {
    // m to mm.
    constexpr double kMm = 1.0 / core::kMillimetre;
    why += fmt::format("; the flight would reach {:.3g} +- {:.2g} mm",
                       state.extrapolated_gap_m->value * kMm,
                       state.extrapolated_gap_m->u * kMm);
  }
  return why;
}

// Nothing where the trial cannot enter; then `why` says why.
std::optional<Observation> ObserveTrial(const core::Trial& trial,
                                        std::string& why) {
  if (trial.excluded) {
    why = "excluded: " + trial.exclusion_reason;
    return std::nullopt;
  }
  const core::Measured angle = core::ContactAngle(trial);
  if (!angle) {
    why = fmt::format("no {} angle: {}", core::Name(trial.angle_kind),
                      angle.error().reason);
    return std::nullopt;
  }
  if (!std::isfinite(angle->value) || !(angle->u >= 0.0) ||
      !std::isfinite(angle->u)) {
    why = "the angle or its uncertainty is not a finite number";
    return std::nullopt;
  }
  Observation out;
  out.angle_rad = angle->value;
  out.u_rad = angle->u;
  out.set_angle_rad = trial.set_angle_rad;
  const core::StateDecision& state = trial.first.state;
  if (state.label == core::MotionState::kBounce) {
    out.outcome = Outcome::kBounce;
    out.p_bounce = DecidedProbability(state, true);
  } else if (core::IsNotBounce(state.label)) {
    out.outcome = Outcome::kNotBounce;
    out.p_bounce = DecidedProbability(state, false);
  } else {
    const auto p_bounce = UndecidedProbability(state);
    if (!p_bounce) {
      why = WhyNoProbability(state);
      return std::nullopt;
    }
    out.p_bounce = *p_bounce;
  }
  return out;
}

}  // namespace

double TotalU(const Observation& observation) {
  return std::hypot(observation.u_rad, observation.common_u_rad);
}

Observation Observe(double angle_rad, double u_rad, double p_bounce) {
  core::Require(angle_rad >= 0.0 && angle_rad <= std::numbers::pi / 2,
                "angle_rad", angle_rad, "from 0 to pi/2");
  core::Require(u_rad >= 0.0 && std::isfinite(u_rad), "u_rad", u_rad,
                "finite and not negative");
  core::Require(p_bounce >= 0.0 && p_bounce <= 1.0, "p_bounce", p_bounce,
                "from 0 to 1");
  Observation out;
  out.angle_rad = angle_rad;
  out.u_rad = u_rad;
  out.p_bounce = p_bounce;
  out.outcome = DecideOutcome(p_bounce);
  return out;
}

std::vector<TrialGroup> GroupTrials(std::span<const core::Trial> trials) {
  using Key =
      std::tuple<std::string, core::BodyKind, core::AngleKind, core::Origin>;
  std::map<Key, TrialGroup> groups;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const core::Trial& trial = trials[i];
    TrialGroup& group = groups[Key{trial.campaign, trial.body.kind,
                                   trial.angle_kind, trial.origin}];
    std::string why;
    if (auto observation = ObserveTrial(trial, why)) {
      observation->trial = i;
      group.observations.push_back(*observation);
    } else {
      group.left_out.push_back({i, why});
    }
  }
  std::vector<TrialGroup> out;
  out.reserve(groups.size());
  for (auto& [key, group] : groups) {
    std::tie(group.campaign, group.body, group.angle_kind, group.origin) = key;
    std::stable_sort(group.observations.begin(), group.observations.end(),
                     [](const Observation& a, const Observation& b) {
                       return a.angle_rad < b.angle_rad;
                     });
    out.push_back(std::move(group));
  }
  return out;
}

}  // namespace touchdown::analysis
