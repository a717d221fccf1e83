// touchdown rig spring|launch|plan|calibrate|example: puts the parts together,
// each of which has its own source.
#include <fmt/core.h>

#include <stdexcept>

#include "app/cli/options.h"
#include "app/cli/rig/rig_commands.h"
#include "touchdown/rig/description.h"

namespace touchdown::cli {

void AddDrawFlags(CLI::App& app, DrawFlags& flags) {
  AddOption(app, "--draws", flags.draws, "Monte Carlo draws").ShowDefault();
  AddOption(app, "--seed", flags.seed, "of the Monte Carlo").ShowDefault();
}

void RequireDraws(std::size_t draws) {
  // With two draws there is a standard deviation; the upper limit is memory.
  constexpr std::size_t kMost = 100'000'000;  // 800 MB a column
  if (draws < 2 || draws > kMost) {
    throw std::invalid_argument(
        fmt::format("--draws is {}, must be within 2 .. {}", draws, kMost));
  }
}

void Print(const Json& json) { fmt::print("{}\n", json.dump(2)); }

void AddRig(CLI::App& app, Action& action) {
  CLI::App* rig = AddCommand(
      app, "rig", "the ejector: springs, launch, set-points, calibration");
  RequireSubcommand(*rig);
  AddRigSpring(*rig, action);
  AddRigLaunch(*rig, action);
  AddRigPlan(*rig, action);
  AddRigCalibrate(*rig, action);
  SetAction(*AddCommand(*rig, "example", "print a commented rig.toml"), action,
            [] {
              fmt::print("{}", rig::ExampleDescription());
              return 0;
            });
}

}  // namespace touchdown::cli
