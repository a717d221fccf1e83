// touchdown rig calibrate finds the stiffness from measured forces, the
// efficiency and losses from measured launch speeds. Each part reads a CSV,
// fits (rig/calibrate.h) and prints the line that belongs into rig.toml.
#include <fmt/core.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/case_file.h"
#include "app/cli/options.h"
#include "app/cli/rig/rig_commands.h"
#include "app/cli/rig/rig_flags.h"
#include "app/cli/rig/rig_print.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/calibrate.h"
#include "touchdown/rig/predict.h"

namespace touchdown::cli {
namespace {

// Holds the flags as typed. `force` and `speeds` are CSV files, of which one
// may be missing; `rig` gives what the fit of the efficiency takes as known.
struct CalibrateFlags {
  RigFlags rig;
  std::string force, speeds, losses = "per-shot";
  double elevation_deg = 0.0;
  bool json = false;
};

// Returns the number of a column with the u of "u_" + column; u = 0 where that
// column is missing, which the fit takes as not stated.
core::Estimate Measured(const CaseRow& row, const std::string& column) {
  return {row.Number(column), row.OptionalNumber("u_" + column).value_or(0.0),
          std::nullopt};
}

// Fits F = F0 + H X to the forces and prints H, or adds it to `out`. A fit that
// the points do not allow is an answer with its reason, not an error.
void CalibrateStiffness(const CalibrateFlags& flags, Json& out) {
  // No column is required here: Number() names the one that is missing.
  const CaseTable table = ReadCases(flags.force, {});
  std::vector<rig::ForcePoint> points;
  for (const CaseRow& row : table.rows) {
    points.push_back({row.Number("compression_mm") * core::kMillimetre,
                      Measured(row, "force_n")});
  }
  rig::StiffnessFitOptions options;
  options.u_compression_m =
      flags.rig.u_compression_mm.value_or(0.0) * core::kMillimetre;
  const auto fit = rig::FitStiffness(points, options);
  if (flags.json) {
    Json one{{"points", points.size()}, {"possible", !!fit}};
    one["reason"] = fit ? Json(nullptr) : Json(fit.error().reason);
    if (fit) {
      one["stiffness_n_per_m"] = EstimateJson(fit->stiffness_n_per_m);
      one["force_at_zero_n"] = EstimateJson(fit->force_at_zero_n);
      one["correlation"] = fit->correlation;
      one["residual_n"] = fit->residual_n;
      one["dof"] = fit->dof;
      one["warnings"] = FindingsJson(fit->findings);
    }
    out["stiffness"] = std::move(one);
    return;
  }
  fmt::print("stiffness from {} forces\n", points.size());
  if (!fit) {
    fmt::print("  absent: {}\n", fit.error().reason);
    return;
  }
  fmt::print("{}{}{}{}",
             ValueLine("stiffness", fit->stiffness_n_per_m, 1.0, "N/m"),
             ValueLine("force at zero", fit->force_at_zero_n, 1.0, "N"),
             ValueLine("scatter of force", fit->residual_n, "N"),
             FindingsText(fit->findings));
  fmt::print(
      "  for rig.toml, [springs]: stiffness_n_per_m = {{ value = {:.6g}, u = "
      "{:.2g} }}\n",
      fit->stiffness_n_per_m.value, fit->stiffness_n_per_m.u);
}

// Returns what is fitted besides the efficiency. Throws std::invalid_argument.
rig::LossModel ParseLosses(const std::string& word) {
  if (word == "none") return rig::LossModel::kNone;
  if (word == "per-shot") return rig::LossModel::kPerShot;
  if (word == "friction") return rig::LossModel::kFriction;
  throw std::invalid_argument(fmt::format(
      "--losses is \"{}\", must be none, per-shot or friction", word));
}

// Fits the efficiency, and with it a loss per shot or the barrel's friction, to
// the launch speeds. Prints it or adds it to `out`.
void CalibrateEfficiency(const CalibrateFlags& flags, Json& out) {
  rig::EfficiencyFitOptions options;
  options.losses = ParseLosses(flags.losses);
  const rig::Description rig = MakeDescription(flags.rig);
  RequireMass(flags.rig);
  const rig::Launch launch =
      rig::MakeLaunch(rig, flags.elevation_deg * core::kDegree);
  std::mt19937_64 engine(1);  // the first order needs no draws
  const rig::Predicted stiffness = rig::PredictStiffness(rig, {2}, engine);
  if (stiffness.first_order) {
    options.u_stiffness_rel =
        stiffness.first_order->u / stiffness.first_order->value;
  }
  // A third of the springs' mass moves with the body (Rayleigh, rig/launch.h);
  // the relative u of the whole moving mass enters the fit.
  const double moving_kg = launch.mass_kg + launch.spring_mass_kg / 3.0;
  const double u_springs_kg =
      rig.springs.mass_kg ? rig.springs.mass_kg->u : 0.0;
  options.u_mass_rel =
      std::hypot(rig.mass_kg.u, u_springs_kg / 3.0) / moving_kg;
  const CaseTable table = ReadCases(flags.speeds, {});
  std::vector<rig::SpeedPoint> points;
  for (const CaseRow& row : table.rows) {
    points.push_back({row.Number("compression_mm") * core::kMillimetre,
                      Measured(row, "speed_mps")});
  }
  const auto fit = rig::FitEfficiency(points, launch, options);
  if (flags.json) {
    Json one{{"points", points.size()},
             {"losses", flags.losses},
             {"possible", !!fit}};
    one["reason"] = fit ? Json(nullptr) : Json(fit.error().reason);
    if (fit) {
      one["efficiency"] = EstimateJson(fit->efficiency);
      one["effective_stiffness_n_per_m"] =
          EstimateJson(fit->effective_stiffness_n_per_m);
      one["loss_j"] = EstimateJson(fit->loss_j);
      one["barrel_friction"] = EstimateJson(fit->barrel_friction);
      one["slope_per_s2"] = fit->slope_per_s2;
      one["residual_m2_per_s2"] = fit->residual_m2_per_s2;
      one["dof"] = fit->dof;
      one["warnings"] = FindingsJson(fit->findings);
    }
    out["efficiency"] = std::move(one);
    return;
  }
  fmt::print("efficiency from {} launch speeds, losses: {}\n", points.size(),
             flags.losses);
  if (!fit) {
    fmt::print("  absent: {}\n", fit.error().reason);
    return;
  }
  fmt::print("{}{}", ValueLine("efficiency", fit->efficiency, 1.0, ""),
             ValueLine("eta H", fit->effective_stiffness_n_per_m, 1.0, "N/m"));
  // Of the losses only the one that was fitted has a number.
  if (options.losses == rig::LossModel::kPerShot) {
    fmt::print("{}", ValueLine("loss per shot", fit->loss_j, 1.0, "J"));
  }
  if (options.losses == rig::LossModel::kFriction) {
    fmt::print("{}",
               ValueLine("barrel friction", fit->barrel_friction, 1.0, ""));
  }
  fmt::print("{}{}",
             ValueLine("scatter of v^2", fit->residual_m2_per_s2, "m2/s2"),
             FindingsText(fit->findings));
  fmt::print(
      "  for rig.toml, [ejector]: efficiency = {{ value = {:.6g}, u = {:.2g} "
      "}}\n",
      fit->efficiency.value, fit->efficiency.u);
}

// Runs the parts whose CSV was given, stiffness first. Returns 0.
int RunCalibrate(const CalibrateFlags& flags) {
  if (flags.force.empty() && flags.speeds.empty()) {
    throw std::invalid_argument(
        "give --force FORCES.csv (compression_mm, force_n[, u_force_n]) or "
        "--speeds SPEEDS.csv (compression_mm, speed_mps[, u_speed_mps])");
  }
  Json out{{"schema", "touchdown.rig.calibrate/1"}};
  if (!flags.force.empty()) CalibrateStiffness(flags, out);
  if (!flags.speeds.empty()) CalibrateEfficiency(flags, out);
  if (flags.json) Print(out);
  return 0;
}

}  // namespace

void AddRigCalibrate(CLI::App& rig, Action& action) {
  auto calibrate = std::make_shared<CalibrateFlags>();
  CLI::App* one = AddCommand(
      rig, "calibrate", "stiffness from forces, efficiency from launch speeds");
  AddSpringFlags(*one, calibrate->rig);
  AddLaunchFlags(*one, calibrate->rig);
  AddOption(*one, "--force", calibrate->force,
            "CSV: compression_mm, force_n[, u_force_n], all springs");
  AddOption(*one, "--speeds", calibrate->speeds,
            "CSV: compression_mm, speed_mps[, u_speed_mps]");
  AddOption(*one, "--losses", calibrate->losses,
            "fitted besides: none, per-shot or friction")
      .ShowDefault();
  AddOption(*one, "--elevation-deg", calibrate->elevation_deg,
            "of the barrel during the shots [0]");
  AddFlag(*one, "--json", calibrate->json, "one JSON document");
  SetAction(*one, action, [calibrate] { return RunCalibrate(*calibrate); });
}

}  // namespace touchdown::cli
