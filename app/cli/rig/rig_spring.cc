// touchdown rig spring gives the springs' stiffness by Eq. (11), stress,
// clearance and surge, for one rig or for a file of them (--cases).
#include <fmt/core.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/options.h"
#include "app/cli/rig/rig_cases.h"
#include "app/cli/rig/rig_commands.h"
#include "app/cli/rig/rig_flags.h"
#include "app/cli/rig/rig_print.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/predict.h"

namespace touchdown::cli {
namespace {

// Holds the flags as typed; `cases` is a CSV that is answered in place of the
// flags.
struct SpringFlags {
  RigFlags rig;
  DrawFlags draw;
  std::string cases;
  std::optional<double> compression_mm;
  bool json = false;
};

// Answers `rig spring`. Returns 0; what the springs do not bear is among the
// findings. `app` tells which flags were given.
int RunSpring(const SpringFlags& flags, const CLI::App& app) {
  if (!flags.cases.empty()) {
    // A case file has draws and seed of its own, those of the reference cases,
    // unless the user typed others.
    RigCasesOptions options;
    for (const GivenOption& option : ListGiven(app)) {
      if (option.name == "--draws") {
        options.draws = flags.draw.draws;
      } else if (option.name == "--seed") {
        options.seed = flags.draw.seed;
      } else if (option.name != "--cases") {
        throw std::invalid_argument(fmt::format(
            "{} goes without --cases, whose file has its own rigs and is "
            "answered in CSV; leave one of the two away",
            option.name));
      }
    }
    RequireDraws(options.draws);
    fmt::print("{}", RigCases(flags.cases, options));
    return 0;
  }
  RequireDraws(flags.draw.draws);
  const rig::Description rig = MakeDescription(flags.rig);
  const auto spring = rig::MakeSpring(rig.springs);
  // Without --compression-mm the springs are checked at the greatest travel of
  // rig.toml, or at the preload alone.
  const double travel_m = flags.compression_mm
                              ? *flags.compression_mm * core::kMillimetre
                              : rig.compression_max_m.value_or(0.0);
  const double whole_m = travel_m + rig.preload_m.value;
  rig::SpringLimits limits;
  limits.free_length_m = rig.springs.free_length_m;
  limits.allowable_shear_pa = rig.springs.allowable_shear_pa;
  std::optional<rig::SpringReport> report;
  // A measured stiffness without a geometry has no stress and no clearance.
  if (spring) report = rig::CheckSpring(*spring, whole_m, limits);
  const std::vector<rig::Finding> findings =
      rig::CheckCompression(rig, travel_m);

  std::mt19937_64 engine(flags.draw.seed);
  const rig::Predicted stiffness =
      rig::PredictStiffness(rig, {flags.draw.draws}, engine);
  if (flags.json) {
    // PredictionJson() writes a stiffness together with its absences, so it is
    // wrapped into a prediction that holds nothing else.
    rig::ContactPrediction only;
    only.stiffness_n_per_m = stiffness;
    Json out{{"schema", "touchdown.rig.spring/1"},
             {"source", rig.springs.stiffness_n_per_m ? "measured" : "eq11"},
             {"compression_mm", whole_m / core::kMillimetre},
             {"stiffness_n_per_m", PredictionJson(only)["stiffness_n_per_m"]}};
    out["spring"] = report ? SpringJson(*report) : Json(nullptr);
    out["allowed"] = rig::Allowed(findings);
    out["warnings"] = FindingsJson(findings);
    Print(out);
    return 0;
  }
  fmt::print("springs: {} side by side, compressed by {:.4g} mm{}\n",
             rig.springs.count, whole_m / core::kMillimetre,
             rig.springs.stiffness_n_per_m ? ", measured stiffness" : "");
  fmt::print("{}", ValueLine("stiffness", stiffness, 1.0, "N/m"));
  if (report) fmt::print("{}", SpringText(*report));
  fmt::print("{}", FindingsText(findings));
  return 0;
}

}  // namespace

void AddRigSpring(CLI::App& rig, Action& action) {
  auto spring = std::make_shared<SpringFlags>();
  CLI::App* one = AddCommand(rig, "spring",
                             "stiffness, Eq. (11), stress, clearance, surge");
  AddSpringFlags(*one, spring->rig);
  AddOption(*one, "--compression-mm", spring->compression_mm,
            "beyond the preload [rig's greatest]");
  AddOption(*one, "--cases", spring->cases,
            "CSV of rigs -> CSV of their numbers (2000000 draws, seed 12345 "
            "unless given)");
  AddDrawFlags(*one, spring->draw);
  AddFlag(*one, "--json", spring->json, "one JSON document");
  SetAction(*one, action, [spring, one] { return RunSpring(*spring, *one); });
}

}  // namespace touchdown::cli
