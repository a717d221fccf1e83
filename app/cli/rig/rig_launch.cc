// touchdown rig launch gives the speed that a compression gives, or the
// compression for a wanted speed, by Eq. (10) and by the energy balance; with a
// muzzle height also the flight and the contact.
#include <fmt/core.h>

#include <memory>
#include <optional>
#include <stdexcept>

#include "app/cli/options.h"
#include "app/cli/rig/rig_commands.h"
#include "app/cli/rig/rig_flags.h"
#include "app/cli/rig/rig_print.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/launch.h"
#include "touchdown/rig/predict.h"

namespace touchdown::cli {
namespace {

// Holds the flags as typed. Without `height_mm` nothing is said of the flight.
struct LaunchFlags {
  RigFlags rig;
  DrawFlags draw;
  std::optional<double> compression_mm, speed_mps, height_mm;
  double elevation_deg = 0.0;
  bool json = false;
};

// Answers `rig launch`. Returns 0 even where the body does not leave the
// muzzle: that is an answer, with the energy balance as its reason.
int RunLaunch(const LaunchFlags& flags) {
  RequireDraws(flags.draw.draws);
  if (flags.compression_mm.has_value() == flags.speed_mps.has_value()) {
    throw std::invalid_argument(
        "give either --compression-mm (what speed?) or --speed-mps (what "
        "compression?)");
  }
  rig::Description rig = MakeDescription(flags.rig);
  RequireMass(flags.rig);
  if (!flags.height_mm) rig.body.reset();  // a point that is not followed
  rig::Setting setting;
  setting.elevation_rad = flags.elevation_deg * core::kDegree;
  setting.muzzle_height_m = flags.height_mm.value_or(0.0) * core::kMillimetre;
  const rig::Launch launch = rig::MakeLaunch(rig, setting.elevation_rad);
  // SolveCompression() answers always; whether the springs bear it is among the
  // findings below.
  setting.compression_m = flags.compression_mm
                              ? *flags.compression_mm * core::kMillimetre
                              : rig::SolveCompression(launch, *flags.speed_mps);
  std::mt19937_64 engine(flags.draw.seed);
  const auto muzzle = rig::LaunchSpeed(launch, setting.compression_m);
  const rig::ContactPrediction contact =
      rig::Predict(rig, setting, {flags.draw.draws}, engine);
  const double ideal = rig::IdealLaunchSpeed(
      setting.compression_m, launch.stiffness_n_per_m, launch.mass_kg);
  if (flags.json) {
    Json out{{"schema", "touchdown.rig.launch/1"},
             {"compression_mm", setting.compression_m / core::kMillimetre},
             {"elevation_deg", flags.elevation_deg},
             {"muzzle_height_mm",
              flags.height_mm ? Json(*flags.height_mm) : Json(nullptr)},
             {"ideal_speed_mps", ideal},
             {"leaves_muzzle", muzzle.has_value()},
             {"reason", muzzle ? Json(nullptr) : Json(muzzle.error().reason)}};
    out["energy_j"] =
        muzzle ? Json{{"springs", muzzle->energy.spring_j},
                      {"losses", muzzle->energy.losses_j},
                      {"gravity", muzzle->energy.gravity_j},
                      {"friction", muzzle->energy.friction_j},
                      {"body", muzzle->energy.body_j},
                      {"spring_motion", muzzle->energy.spring_motion_j}}
               : Json(nullptr);
    out["allowed"] = rig::Allowed(contact.findings);
    Json predicted = PredictionJson(contact);
    // Predict() was given height 0 for want of one: what it says of the flight
    // is taken out, each field with its reason.
    if (!flags.height_mm) {
      for (const char* name :
           {"impact_speed_mps", "approach_angle_deg", "flight_time_s",
            "range_mm", "radius_angle_deg", "face_angle_deg", "corner"}) {
        predicted[name] = nullptr;
        predicted["absent"][name] = "no --height-mm";
      }
    }
    out["contact"] = std::move(predicted);
    Print(out);
    return 0;
  }
  fmt::print("launch: compression {:.4f} mm, elevation {:g} deg{}\n",
             setting.compression_m / core::kMillimetre, flags.elevation_deg,
             flags.height_mm
                 ? fmt::format(", muzzle height {:g} mm", *flags.height_mm)
                 : ", no --height-mm: no flight");
  if (!muzzle) {
    fmt::print("  {}\n", muzzle.error().reason);
  } else {
    fmt::print("{}", PredictionText(contact, flags.height_mm.has_value()));
    fmt::print("{}", ValueLine("ideal speed, Eq. (10)", ideal, "m/s"));
    // The line balances: left of the sign the springs' energy, right of it all
    // that it became.
    const rig::EnergyBalance& e = muzzle->energy;
    fmt::print(
        "  energy, J: springs {:.4g} = losses {:.4g} + gravity {:.4g} + "
        "friction {:.4g} + body {:.4g} + motion of springs {:.4g}\n",
        e.spring_j, e.losses_j, e.gravity_j, e.friction_j, e.body_j,
        e.spring_motion_j);
  }
  fmt::print("{}", FindingsText(contact.findings));
  return 0;
}

}  // namespace

void AddRigLaunch(CLI::App& rig, Action& action) {
  auto launch = std::make_shared<LaunchFlags>();
  CLI::App* one = AddCommand(
      rig, "launch",
      "speed from compression or back, Eq. (10) and its corrections");
  AddSpringFlags(*one, launch->rig);
  AddLaunchFlags(*one, launch->rig);
  AddOption(*one, "--compression-mm", launch->compression_mm,
            "X, beyond the preload");
  AddOption(*one, "--speed-mps", launch->speed_mps, "wanted at the muzzle");
  AddOption(*one, "--elevation-deg", launch->elevation_deg,
            "barrel above horizontal [0]");
  AddOption(*one, "--height-mm", launch->height_mm,
            "of the body's centre at the muzzle; gives the contact too");
  AddDrawFlags(*one, launch->draw);
  AddFlag(*one, "--json", launch->json, "one JSON document");
  SetAction(*one, action, [launch] { return RunLaunch(*launch); });
}

}  // namespace touchdown::cli
