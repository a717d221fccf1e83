#include "touchdown/rig/predict.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "angles.h"
#include "infinity.h"
#include "touchdown/core/require.h"
#include "touchdown/rig/flight.h"
#include "touchdown/rig/turning_flight.h"

namespace touchdown::rig {
namespace {

// Everything that varies from draw to draw.
struct State {
  Description rig;
  Setting setting;
  double dead_coils = 0.0;  // they stay dead when the active ones vary
};

// An uncertain input, and where its value belongs in a State.
struct Slot {
  UncertainInput input;
  double* (*place)(State&);
};

std::vector<Slot> ListSlots(const State& s) {
  std::vector<Slot> slots;
  const auto add = [&](const char* name, const core::Estimate& e, double low,
                       double high, double* (*place)(State&)) {
    if (e.u > 0.0) slots.push_back({{name, e, low, high}, place});
  };
  const Springs& springs = s.rig.springs;
  // With a measured stiffness the geometry only feeds the springs' mass, whose
  // share of the uncertainty is negligible; it is held then.
  if (springs.stiffness_n_per_m) {
    add("stiffness", *springs.stiffness_n_per_m, 0.0, kInf,
        [](State& t) { return &t.rig.springs.stiffness_n_per_m->value; });
  } else if (springs.geometry) {
    const SpringGeometry& g = *springs.geometry;
    add("shear modulus", g.shear_modulus_pa, 0.0, kInf, [](State& t) {
      return &t.rig.springs.geometry->shear_modulus_pa.value;
    });
    add("wire diameter", g.wire_diameter_m, 0.0, kInf, [](State& t) {
      return &t.rig.springs.geometry->wire_diameter_m.value;
    });
    add("coil diameter", g.coil_diameter_m, 0.0, kInf, [](State& t) {
      return &t.rig.springs.geometry->coil_diameter_m.value;
    });
    add("active coils", g.active_coils, 0.0, kInf,
        [](State& t) { return &t.rig.springs.geometry->active_coils.value; });
  }
  if (springs.mass_kg) {
    add("spring mass", *springs.mass_kg, 0.0, kInf,
        [](State& t) { return &t.rig.springs.mass_kg->value; });
  }
  add("preload", s.rig.preload_m, 0.0, kInf,
      [](State& t) { return &t.rig.preload_m.value; });
  add("compression",
      {s.setting.compression_m, s.rig.u_compression_m, std::nullopt}, 0.0, kInf,
      [](State& t) { return &t.setting.compression_m; });
  add("efficiency", s.rig.efficiency, 0.0, kInf,
      [](State& t) { return &t.rig.efficiency.value; });
  add("barrel friction", s.rig.barrel_friction, -kInf, kInf,
      [](State& t) { return &t.rig.barrel_friction.value; });
  add("loss per shot", s.rig.loss_j, -kInf, kInf,
      [](State& t) { return &t.rig.loss_j.value; });
  add("body mass", s.rig.mass_kg, 0.0, kInf,
      [](State& t) { return &t.rig.mass_kg.value; });
  add("elevation",
      {s.setting.elevation_rad, s.rig.u_elevation_rad, std::nullopt}, -kInf,
      kInf, [](State& t) { return &t.setting.elevation_rad; });
  add("muzzle height",
      {s.setting.muzzle_height_m, s.rig.u_muzzle_height_m, std::nullopt}, -kInf,
      kInf, [](State& t) { return &t.setting.muzzle_height_m; });
  add("gravity", s.rig.gravity_mps2, 0.0, kInf,
      [](State& t) { return &t.rig.gravity_mps2.value; });
  if (s.rig.body && s.rig.body->kind == core::BodyKind::kSphere) {
    add("diameter", *s.rig.body->diameter_m, 0.0, kInf,
        [](State& t) { return &t.rig.body->diameter_m->value; });
  } else if (s.rig.body) {
    add("long side", *s.rig.body->long_m, 0.0, kInf,
        [](State& t) { return &t.rig.body->long_m->value; });
    add("short side", *s.rig.body->short_m, 0.0, kInf,
        [](State& t) { return &t.rig.body->short_m->value; });
    add("seat angle", s.rig.seat_angle_rad, -kInf, kInf,
        [](State& t) { return &t.rig.seat_angle_rad.value; });
    add("spin at release", s.rig.spin_rad_per_s, -kInf, kInf,
        [](State& t) { return &t.rig.spin_rad_per_s.value; });
  }
  return slots;
}

enum Output : std::size_t {
  kStiffness,
  kLaunchSpeed,
  kImpactSpeed,
  kApproach,
  kRadius,
  kFace,
  kTime,
  kRange,
  kOutputs
};

struct Outcome {
  std::array<double, kOutputs> values{};
  std::optional<core::Corner> corner;
  std::vector<Finding> findings;
};

// The angles of a throw seen so that x is the direction of travel. A draw whose
// barrel passes the vertical throws the other way: its mirror image.
struct Release {
  double elevation_rad = 0.0;
  double seat_rad = 0.0;
  double spin_rad_per_s = 0.0;
};

Release MakeRelease(const State& s) {
  const double elevation = s.setting.elevation_rad;
  const double seat = s.rig.seat_angle_rad.value;
  const double spin = s.rig.spin_rad_per_s.value;
  if (std::abs(elevation) <= kQuarterTurn) return {elevation, seat, spin};
  return {std::copysign(2.0 * kQuarterTurn, elevation) - elevation, -seat,
          -spin};
}

core::Expected<TurningFlight> FlyRelease(const Description& rig,
                                         const Release& release,
                                         double speed_mps, double height_m) {
  const double g = rig.gravity_mps2.value;
  if (ThrowsRectangle(rig)) {
    return FlyTurning({.long_m = rig.body->long_m->value,
                       .short_m = rig.body->short_m->value,
                       .speed_mps = speed_mps,
                       .elevation_rad = release.elevation_rad,
                       .height_m = height_m,
                       .face_rad = release.elevation_rad + release.seat_rad,
                       .spin_rad_per_s = release.spin_rad_per_s,
                       .gravity_mps2 = g});
  }
  const double drop = height_m - CentreHeightAtTouchdown(rig, 0.0);
  if (drop < 0.0) {
    return core::AbsentBecause(fmt::format(
        "the body would start {:.3g} mm deep in the ground: raise the muzzle",
        -drop * 1e3));
  }
  return TurningFlight{Fly(speed_mps, release.elevation_rad, drop, g), 0.0};
}

core::Expected<Outcome> Simulate(const State& s) {
  const Description& rig = s.rig;
  const Release release = MakeRelease(s);
  const double elevation = release.elevation_rad;
  Launch launch = MakeLaunch(rig, elevation);
  launch.loss_j = std::fmax(0.0, launch.loss_j);
  launch.barrel_friction = std::fmax(0.0, launch.barrel_friction);
  const auto muzzle = LaunchSpeed(launch, s.setting.compression_m);
  if (!muzzle) return core::AbsentBecause(muzzle.error().reason);
  Outcome out;
  const auto flown =
      FlyRelease(rig, release, muzzle->speed_mps, s.setting.muzzle_height_m);
  if (!flown) return core::AbsentBecause(flown.error().reason);
  const Flight& flight = flown->flight;
  out.values[kStiffness] = launch.stiffness_n_per_m;
  out.values[kLaunchSpeed] = muzzle->speed_mps;
  out.values[kImpactSpeed] = flight.impact_speed_mps;
  out.values[kApproach] = flight.approach_angle_rad;
  out.values[kTime] = flight.time_s;
  out.values[kRange] = flight.range_m;
  if (ThrowsRectangle(rig)) {
    // A long side has no direction: half turns are the same face.
    const double face = std::remainder(flown->face_rad, 2.0 * kQuarterTurn);
    const Landing landing =
        Land(rig.body->long_m->value, rig.body->short_m->value, face);
    out.values[kFace] = face;
    out.values[kRadius] = landing.radius_angle_rad;
    out.corner = landing.corner;
  }
  out.findings = muzzle->findings;
  return out;
}

// The State with the inputs' values put in.
core::Expected<Outcome> SimulateInputs(State& scratch,
                                       const std::vector<Slot>& slots,
                                       std::span<const double> values) {
  for (std::size_t i = 0; i < slots.size(); ++i) {
    *slots[i].place(scratch) = values[i];
  }
  if (auto& geometry = scratch.rig.springs.geometry) {
    geometry->total_coils = geometry->active_coils.value + scratch.dead_coils;
  }
  try {
    return Simulate(scratch);
  } catch (const std::invalid_argument& error) {
    // Each input is in its range, but their combination is impossible, e.g. a
    // coil narrower than its wire: an outcome of a draw, not a caller's
    // mistake.
    return core::AbsentBecause(error.what());
  }
}

void Fill(Predicted& out, const core::Expected<std::vector<FirstOrder>>& gum,
          const MonteCarloRun& run, std::size_t index) {
  if (gum) {
    out.first_order = (*gum)[index].estimate;
    out.budget = (*gum)[index].budget;
    std::erase_if(out.budget, [](const auto& line) { return line.u == 0.0; });
    std::sort(out.budget.begin(), out.budget.end(),
              [](const auto& a, const auto& b) { return a.u > b.u; });
  } else {
    out.first_order = core::AbsentBecause(gum.error().reason);
  }
  if (run.outputs.empty()) {
    out.monte_carlo = core::AbsentBecause(
        gum ? "fewer than 2 draws gave an answer" : gum.error().reason);
    return;
  }
  out.monte_carlo = run.outputs[index];
  out.first_order_valid =
      out.first_order && FirstOrderIsValid(*out.first_order, *out.monte_carlo);
}

void AddFindings(const Description& rig, ContactPrediction& out) {
  if (out.p_no_contact > 0.0) {
    out.findings.push_back(
        {Severity::kWarning,
         fmt::format(
             "{:.2g} % of the draws give no contact; intervals speak of "
             "the others",
             100.0 * out.p_no_contact)});
  }
  if (ThrowsRectangle(rig) && out.face_angle_rad.first_order) {
    const core::Estimate& face = *out.face_angle_rad.first_order;
    if (std::abs(face.value) < 2.0 * face.u) {
      out.findings.push_back(
          {Severity::kWarning,
           fmt::format(
               "which corner lands first is not decided: the face angle "
               "is {:.2f} +- {:.2f} deg",
               face.value / core::kDegree, face.u / core::kDegree)});
    }
  }
}

}  // namespace

double CentreHeightAtTouchdown(const Description& rig, double face_angle_rad) {
  if (!rig.body) return 0.0;
  if (rig.body->kind == core::BodyKind::kSphere) {
    return 0.5 * rig.body->diameter_m->value;
  }
  return Land(rig.body->long_m->value, rig.body->short_m->value,
              std::remainder(face_angle_rad, std::numbers::pi))
      .centre_height_m;
}

ContactPrediction Predict(const Description& rig, const Setting& setting,
                          const PredictOptions& options,
                          std::mt19937_64& engine) {
  if (!(std::abs(setting.elevation_rad) <= kQuarterTurn * (1.0 + 1e-12))) {
    core::Refuse("elevation_rad", setting.elevation_rad,
                 "within -pi/2 .. pi/2");
  }
  ContactPrediction out;
  out.draws = options.draws;
  // Impossible arguments throw here, by name, before anything is drawn.
  State nominal{rig, setting};
  if (const auto& geometry = rig.springs.geometry) {
    nominal.dead_coils = geometry->total_coils - geometry->active_coils.value;
  }
  const auto outcome = Simulate(nominal);
  const std::vector<Slot> slots = ListSlots(nominal);
  std::vector<UncertainInput> inputs;
  inputs.reserve(slots.size());
  for (const Slot& slot : slots) inputs.push_back(slot.input);
  State scratch = nominal;
  const Model model = [&](std::span<const double> values)
      -> core::Expected<std::vector<double>> {
    const auto answer = SimulateInputs(scratch, slots, values);
    if (!answer) return core::AbsentBecause(answer.error().reason);
    return std::vector<double>(answer->values.begin(), answer->values.end());
  };
  const auto gum = PropagateFirstOrder(inputs, model);
  const MonteCarloRun run =
      PropagateMonteCarlo(inputs, model, options.draws, engine);
  const std::array<std::pair<Output, Predicted*>, kOutputs> outputs{{
      {kStiffness, &out.stiffness_n_per_m},
      {kLaunchSpeed, &out.launch_speed_mps},
      {kImpactSpeed, &out.impact_speed_mps},
      {kApproach, &out.approach_angle_rad},
      {kRadius, &out.radius_angle_rad},
      {kFace, &out.face_angle_rad},
      {kTime, &out.flight_time_s},
      {kRange, &out.range_m},
  }};
  for (const auto& [index, predicted] : outputs) {
    if (!ThrowsRectangle(rig) && (index == kRadius || index == kFace)) {
      predicted->first_order = core::AbsentBecause("not a rectangle");
      predicted->monte_carlo = core::AbsentBecause("not a rectangle");
      continue;
    }
    Fill(*predicted, gum, run, index);
  }
  out.p_no_contact =
      static_cast<double>(run.impossible) / static_cast<double>(run.draws);
  out.findings = CheckCompression(rig, setting.compression_m);
  if (outcome) {
    out.corner = outcome->corner;
    out.findings.insert(out.findings.end(), outcome->findings.begin(),
                        outcome->findings.end());
  }
  AddFindings(rig, out);
  return out;
}

Predicted PredictStiffness(const Description& rig,
                           const PredictOptions& options,
                           std::mt19937_64& engine) {
  // The springs alone: what a launch needs besides does not enter.
  Description springs;
  springs.springs = rig.springs;
  springs.mass_kg = {1.0, 0.0, std::nullopt};
  springs.gravity_mps2 = {core::kStandardGravity_mps2, 0.0, std::nullopt};
  const Setting setting{1.0, 0.0, 0.0};
  return Predict(springs, setting, options, engine).stiffness_n_per_m;
}

}  // namespace touchdown::rig
