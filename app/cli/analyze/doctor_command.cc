// touchdown doctor finds what would stand in the way of a measurement, before
// it does.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <sstream>
#include <string>

#include "app/cli/analyze/doctor_flags.h"
#include "app/cli/command.h"
#include "app/cli/defaults.h"
#include "app/cli/messages.h"
#include "app/cli/options.h"
#include "app/text/dates.h"
#include "touchdown/core/errors.h"

namespace touchdown::cli {
namespace {

// This is the exit status where something that was asked for will not work. It
// is that of an input that cannot be read.
constexpr int kTroubleFound = 3;

// `doctor` names what is to be looked at (doctor_flags.h).
struct DoctorCommandFlags {
  DoctorFlags doctor;
  bool json = false;
};

// Prints every finding, as text or as touchdown.doctor/1. Returns 0, or
// kTroubleFound where at least one finding is trouble.
int RunDoctor(const DoctorCommandFlags& flags) {
  auto findings = pipeline::Examine(ToOptions(flags.doctor));
  try {
    ReadDefaults("");
  } catch (const core::InputError& error) {
    findings.push_back(
        {"defaults", pipeline::Health::kTrouble, error.what(),
         "mend or remove the file; `touchdown use STORE` writes a new one"});
  }
  if (flags.json) {
    fmt::print("{}\n", pipeline::ToJson(findings));
  } else {
    // Names of files and devices stand in the text: it is made printable line
    // by line, since Printable() would escape the line feeds too.
    std::istringstream lines(pipeline::ToText(findings));
    for (std::string line; std::getline(lines, line);) {
      fmt::print("{}\n", Printable(line));
    }
  }
  const bool trouble =
      std::any_of(findings.begin(), findings.end(), [](const auto& finding) {
        return finding.health == pipeline::Health::kTrouble;
      });
  return trouble ? kTroubleFound : 0;
}

}  // namespace

void AddDoctorFlags(CLI::App& command, DoctorFlags& flags) {
  AddOption(command, "--db", flags.store, "a trial store to look at");
  AddOption(command, "--calibration", flags.calibration,
            "a calibration file to look at");
  // The earlier name of --calibration, which scripts may still have.
  AddOption(command, "--camera", flags.calibration, "as --calibration").Hide();
  AddOption(
      command, "--recordings", flags.recordings,
      "the folder that the camera writes into: its newest recording is opened");
}

pipeline::DoctorOptions ToOptions(const DoctorFlags& flags) {
  pipeline::DoctorOptions options;
  options.store = flags.store;
  options.calibration = flags.calibration;
  options.recordings = flags.recordings;
  // The module takes no clock, so that its findings can be tested.
  options.today = pipeline::Today();
  options.now = std::chrono::system_clock::now();
  return options;
}

void AddDoctor(CLI::App& app, Action& action) {
  auto flags = std::make_shared<DoctorCommandFlags>();
  CLI::App* command =
      AddCommand(app, "doctor",
                 "what of this machine, its store and its camera would stand "
                 "in the way (exit status 3 where something will not work)");
  AddDoctorFlags(*command, flags->doctor);
  AddFlag(*command, "--json", flags->json, "one JSON document on stdout");
  SetAction(*command, action, [flags] { return RunDoctor(*flags); });
}

}  // namespace touchdown::cli
