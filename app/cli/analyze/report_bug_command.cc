// touchdown report-bug makes an archive for whoever is to find out what went
// wrong. It takes the flags of `analyze` and runs that once more in a process
// of its own (app/doctor/bug_report.h); nothing is sent anywhere.
#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/cli/analyze/analyze_flags.h"
#include "app/cli/command.h"
#include "app/cli/messages.h"
#include "app/cli/options.h"
#include "app/doctor/bug_report.h"
#include "app/text/dates.h"

namespace touchdown::cli {
namespace {

// Holds the flags as typed. `pictures` is the most frames that go into the
// archive.
struct ReportBugFlags {
  std::string clip;
  AnalyzeFlags analyze;
  std::vector<std::string> typed;  // of the flags of `analyze`
  std::string out = "touchdown-bug.zip";
  int pictures = 8;
  bool yes = false;
};

// Returns the flags of `analyze` as they were typed, all but this command's
// own, so that the process that analyses gets the same line.
std::vector<std::string> ListTyped(const CLI::App& command) {
  const std::set<std::string> own = {"CLIP", "--out", "--pictures", "--yes"};
  std::vector<std::string> typed;
  for (const GivenOption& option : ListGiven(command)) {
    if (own.contains(option.name)) continue;
    typed.push_back(option.is_flag ? option.name
                                   : option.name + "=" + option.values.back());
  }
  return typed;
}

// Asks on stderr whether the archive may be written, and reads the answer from
// stdin; anything but y or yes means no. Throws std::invalid_argument where
// stdin ends: a script must say --yes.
bool IsWanted(const ReportBugFlags& flags) {
  if (flags.yes) return true;
  Tell(fmt::format("write these into {}? [y/N]", flags.out));
  std::string answer;
  if (!std::getline(std::cin, answer)) {
    throw std::invalid_argument(
        "report-bug asks before it writes, and nobody answered; give --yes");
  }
  return answer == "y" || answer == "Y" || answer == "yes";
}

// Shows what the archive would hold, asks, and writes it. Returns 0, also where
// the answer was no.
int RunReportBug(const ReportBugFlags& flags) {
  ToOptions(flags.analyze);  // what is wrong is said before all else
  pipeline::BugOptions options;
  options.clip = flags.clip;
  options.flags = flags.typed;
  options.frames = flags.pictures;
  if (!flags.analyze.calibration.empty()) {
    options.also.emplace_back(flags.analyze.calibration);
  }
  options.doctor.today = pipeline::Today();
  options.doctor.now = std::chrono::system_clock::now();
  const std::vector<pipeline::BugFile> files = pipeline::CollectBug(options);
  // Sizes are rounded up: a small file is not shown as 0 kB.
  constexpr std::size_t kKilobyte = 1000;
  for (const pipeline::BugFile& file : files) {
    fmt::print("{:<28} {:>8} kB  {}\n", Printable(file.name),
               (file.bytes.size() + kKilobyte - 1) / kKilobyte, file.what);
  }
  fmt::print(
      "These show what the camera saw, names of files and what machine this "
      "is. Nothing is sent.\n");
  // The question refers to the list, which must be on the screen before it.
  RequireStdoutWritten();
  if (!IsWanted(flags)) {
    Tell("nothing was written");
    return 0;
  }
  pipeline::WriteBug(files, flags.out);
  fmt::print("{}\n", Printable(flags.out));
  return 0;
}

}  // namespace

void AddReportBug(CLI::App& app, Action& action) {
  auto flags = std::make_shared<ReportBugFlags>();
  CLI::App* command = AddCommand(
      app, "report-bug",
      "analyse a recording and put the answer, the log, the options, the "
      "machine and some frames into one ZIP file, after showing what is in it");
  AddAnalyzeFlags(*command, flags->analyze);
  AddOption(*command, "CLIP", flags->clip, "the recording").Require();
  AddOption(*command, "--out", flags->out, "the ZIP file").ShowDefault();
  AddOption(*command, "--pictures", flags->pictures,
            "frames of the recording in it, at most; 0: none")
      .ShowDefault();
  AddFlag(*command, "--yes", flags->yes, "write it without asking");
  SetAction(*command, action, [flags, command] {
    flags->typed = ListTyped(*command);
    return RunReportBug(*flags);
  });
}

}  // namespace touchdown::cli
