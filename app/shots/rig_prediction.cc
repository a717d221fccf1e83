#include "app/shots/rig_prediction.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <random>
#include <tuple>
#include <utility>

#include "app/text/format.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/launch.h"
#include "touchdown/rig/predict.h"
#include "touchdown/rig/setpoints.h"
#include "touchdown/vision/footage/clip_digest.h"

namespace touchdown::pipeline {
namespace {

using core::kDegree;
using core::kMillimetre;

// Draws of the Monte Carlo beside the first order: u to 2 %, which E_n shows to
// two digits.
constexpr std::size_t kDraws = 2000;

// The setting whose body leaves the muzzle at `launch_mps`: the speed at
// touchdown, which set-points begin from, is found by the secant method in the
// squares of both speeds. In them a level shot is a line, of slope cos^2 of the
// approach angle, and any shot nearly one.
core::Expected<rig::Setting> SettingAtLaunch(const rig::Description& rig,
                                             rig::ContactWish wish,
                                             double launch_mps) {
  // A level shot takes one or two turns, each of which costs a FindSetting.
  // This many halve an interval below kClose, where the line bends.
  constexpr int kTurns = 60;
  // Relative error of the launch speed that ends the search: far below what any
  // rig sets, so that the result does not depend on where it stops.
  constexpr double kClose = 1e-9;
  const double wanted = launch_mps * launch_mps;
  double square = wanted;  // of the speed at touchdown, (m/s)^2
  if (wish.kind == core::AngleKind::kApproach) {
    // Of a level shot, or of one from the highest muzzle where a level one
    // falls farther: the launch speed itself may be less than any fall gives.
    const double across = std::cos(wish.angle_rad);
    square =
        std::min(wanted / (across * across),
                 wanted + 2 * rig.gravity_mps2.value * rig.muzzle_height_max_m);
  }
  // Squares of which the launch is known to be too slow and too fast.
  double low = 0.0;
  double high = std::numeric_limits<double>::infinity();
  // Energy adds up: where the fall stays the same, what the launch lacks in v^2
  // is what touchdown lacks.
  double slope = 1.0;
  // Squares of the last turn, at touchdown and at launch.
  std::optional<std::pair<double, double>> last;
  for (int i = 0; i < kTurns; ++i) {
    wish.speed_mps = std::sqrt(square);
    auto setting = rig::FindSetting(rig, wish);
    if (!setting) return setting;
    const auto muzzle = rig::LaunchSpeed(
        rig::MakeLaunch(rig, setting->elevation_rad), setting->compression_m);
    if (!muzzle) return core::AbsentBecause(muzzle.error().reason);
    const double v = muzzle->speed_mps;
    if (std::abs(v - launch_mps) <= kClose * launch_mps) return setting;
    const double lacking = wanted - v * v;
    (lacking > 0.0 ? low : high) = square;
    if (last) slope = (v * v - last->second) / (square - last->first);
    last = {square, v * v};
    double next = square + lacking / slope;
    // A step out of the interval, or none, comes of a bend.
    if (!(next > low && next < high)) {
      next = std::isfinite(high) ? (low + high) / 2 : square + lacking;
    }
    square = next;
  }
  return core::AbsentBecause(
      "the rig has no setting with this angle at this launch speed");
}

// What of a prediction is the same for all trials of one set-point.
struct Planned {
  report::ShotPrediction prediction;
  double fall_m = 0.0;
  bool possible = false;
};

// Makes a plan in which all three numbers are absent for the same reason.
Planned Refused(const std::string& reason) {
  Planned out;
  out.prediction = {core::AbsentBecause(reason), core::AbsentBecause(reason),
                    core::AbsentBecause(reason)};
  return out;
}

// Predicts what the trial's set-points lead to; refused, with the reason, where
// the rig cannot be asked or cannot do it.
Planned Plan(const rig::Description& rig, const core::Trial& trial) {
  if (!trial.set_angle_rad) return Refused("no set-point of the angle");
  if (!trial.set_speed_mps || !(*trial.set_speed_mps > 0.0)) {
    return Refused("no set-point of the launch speed");
  }
  if (rig.body && rig.body->kind != trial.body.kind) {
    return Refused(
        fmt::format("the rig throws a {}", core::Name(rig.body->kind)));
  }
  rig::ContactWish wish;
  wish.kind = trial.angle_kind;
  wish.angle_rad = *trial.set_angle_rad;
  // The corner that landed first belongs to the throw: the same radius angle is
  // reached nose up and nose down by two settings.
  wish.corner = trial.first.contact.corner;
  const double highest = std::numbers::pi / 2;
  const double lowest = wish.kind == core::AngleKind::kFace ? -highest : 0.0;
  if (!(wish.angle_rad >= lowest && wish.angle_rad <= highest)) {
    return Refused("the set-point is no angle of this kind");
  }
  const auto setting = SettingAtLaunch(rig, wish, *trial.set_speed_mps);
  if (!setting) return Refused(setting.error().reason);
  // The seed is fixed, so that the same trials give the same report, digit by
  // digit.
  std::mt19937_64 engine(1);
  const auto contact = rig::Predict(rig, *setting, {kDraws}, engine);
  Planned out;
  out.prediction.launch_speed_mps = contact.launch_speed_mps.first_order;
  out.prediction.approach_angle_rad = contact.approach_angle_rad.first_order;
  const auto& launch = contact.launch_speed_mps.first_order;
  const auto& impact = contact.impact_speed_mps.first_order;
  if (!launch || !impact) return Refused("the body would not reach the ground");
  // Height of the fall from the speeds, in m: h = (v^2 - v0^2) / 2g.
  out.fall_m = (impact->value * impact->value - launch->value * launch->value) /
               (2 * rig.gravity_mps2.value);
  out.possible = true;
  return out;
}

// Returns the launch speed that a measured speed at touchdown tells, in m/s: v0
// = sqrt(v^2 - 2 g h). u is of first order in v, h and g; h is known as well as
// the muzzle's height is.
core::Measured LaunchFromTouchdown(const rig::Description& rig, double fall_m,
                                   const core::Measured& touchdown_mps) {
  if (!touchdown_mps) return touchdown_mps;
  const double g = rig.gravity_mps2.value;
  const double square =
      touchdown_mps->value * touchdown_mps->value - 2 * g * fall_m;
  if (!(square > 0.0)) {
    return core::AbsentBecause("slower at touchdown than the fall alone");
  }
  const double v = std::sqrt(square);
  return core::Estimate{
      v,
      std::hypot(touchdown_mps->value * touchdown_mps->u,
                 g * rig.u_muzzle_height_m, fall_m * rig.gravity_mps2.u) /
          v,
      {}};
}

// Adds to the plan of a set-point what this trial alone can tell.
report::ShotPrediction ForTrial(const rig::Description& rig,
                                const Planned& planned,
                                const core::Trial& trial) {
  report::ShotPrediction out = planned.prediction;
  if (planned.possible) {
    out.measured_launch_speed_mps = LaunchFromTouchdown(
        rig, planned.fall_m, trial.first.motion.before_speed_mps);
  }
  return out;
}

}  // namespace

report::ShotPrediction PredictShot(const rig::Description& rig,
                                   const core::Trial& trial) {
  return ForTrial(rig, Plan(rig, trial), trial);
}

report::RigUsed PredictTrials(const std::filesystem::path& rig_file,
                              std::span<const core::Trial> trials) {
  const rig::Description rig = rig::ReadDescription(rig_file);
  report::RigUsed out;
  // Facts are lines of the report, in this order: name and value.
  const auto fact = [&](const char* name, std::string value) {
    out.facts.emplace_back(name, std::move(value));
  };
  fact("rig", rig.name.empty() ? "without a name" : rig.name);
  fact("its description",
       fmt::format("{}, SHA-256 {}", rig_file.filename().string(),
                   vision::Sha256(rig_file)));
  std::mt19937_64 engine(1);
  const auto stiffness = rig::PredictStiffness(rig, {kDraws}, engine);
  if (stiffness.first_order) {
    fact("its springs", fmt::format("{}, {} N/m together", rig.springs.count,
                                    report::WithU(*stiffness.first_order, 1)));
  }
  fact("its elevation",
       fmt::format("{} to {} deg",
                   report::Plain(rig.elevation_min_rad / kDegree),
                   report::Plain(rig.elevation_max_rad / kDegree)));
  fact("its muzzle height",
       fmt::format("{} to {} mm",
                   report::Plain(rig.muzzle_height_min_m / kMillimetre),
                   report::Plain(rig.muzzle_height_max_m / kMillimetre)));
  if (rig.body) {
    fact("its body", std::string(core::Name(rig.body->kind)));
  }
  // One plan for all trials of one set-point: a campaign has few.
  std::map<std::tuple<double, double, core::AngleKind, core::BodyKind, int>,
           Planned>
      plans;
  for (const core::Trial& trial : trials) {
    if (!trial.set_angle_rad && !trial.set_speed_mps) continue;
    const auto& corner = trial.first.contact.corner;
    // -1 stands for what is not set: no angle in radians of a protocol is that
    // by chance, no speed is negative.
    const std::tuple key(trial.set_angle_rad.value_or(-1.0),
                         trial.set_speed_mps.value_or(-1.0), trial.angle_kind,
                         trial.body.kind,
                         corner ? static_cast<int>(*corner) : -1);
    auto plan = plans.find(key);
    if (plan == plans.end()) plan = plans.emplace(key, Plan(rig, trial)).first;
    out.predictions[trial.id] = ForTrial(rig, plan->second, trial);
  }
  return out;
}

}  // namespace touchdown::pipeline
