#include <dlfcn.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iterator>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "app/cli/command.h"
#include "app/cli/defaults.h"
#include "app/cli/interruption.h"
#include "app/cli/log_setup.h"
#include "app/cli/messages.h"
#include "app/measure/journal.h"
#include "app/text/version.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/nearest.h"
#include "touchdown/vision/footage/clip_apart.h"

namespace {

enum ExitStatus : int {
  kUsage = 2,   // wrong usage or impossible argument
  kInput = 3,   // input unreadable, damaged or unsupported
  kStore = 4,   // trial store trouble
  kOutput = 6,  // output could not be written
  kDefect = 70
};

struct Command {
  std::string_view name;
  void (*add)(CLI::App&, touchdown::cli::Action&);
};
constexpr Command kCommands[] = {{"analyze", touchdown::cli::AddAnalyze},
                                 {"batch", touchdown::cli::AddBatch},
                                 {"calibrate", touchdown::cli::AddCalibrate},
                                 {"simulate", touchdown::cli::AddSimulate},
                                 {"boundary", touchdown::cli::AddBoundary},
                                 {"next", touchdown::cli::AddNext},
                                 {"report", touchdown::cli::AddReport},
                                 {"review", touchdown::cli::AddReview},
                                 {"list", touchdown::cli::AddList},
                                 {"show", touchdown::cli::AddShow},
                                 {"log", touchdown::cli::AddLog},
                                 {"correct", touchdown::cli::AddCorrect},
                                 {"campaign", touchdown::cli::AddCampaign},
                                 {"register", touchdown::cli::AddRegister},
                                 {"import", touchdown::cli::AddImport},
                                 {"export", touchdown::cli::AddExport},
                                 {"db", touchdown::cli::AddDb},
                                 {"session", touchdown::cli::AddSession},
                                 {"rig", touchdown::cli::AddRig},
                                 {"theory", touchdown::cli::AddTheory},
                                 {"use", touchdown::cli::AddUse},
                                 {"demo", touchdown::cli::AddDemo},
                                 {"doctor", touchdown::cli::AddDoctor},
                                 {"report-bug", touchdown::cli::AddReportBug}};

// Of the build, which tells of all others; no user is told of it.
constexpr std::string_view kDescribe = "describe";

// The command of that name alone: to make all takes milliseconds. Those of
// another name, such as --help, see all of them.
void AddCommands(CLI::App& app, touchdown::cli::Action& action,
                 std::string_view name) {
  const auto* const one = std::find_if(
      std::begin(kCommands), std::end(kCommands),
      [&](const Command& command) { return command.name == name; });
  for (const Command& command : kCommands) {
    if (one == std::end(kCommands) || one->name == command.name) {
      command.add(app, action);
    }
  }
  if (name == kDescribe) touchdown::cli::AddDescribe(app, action);
}

// What to say of a first word that is no command; empty where it is one, or an
// option.
std::string UnknownCommand(std::string_view word) {
  if (word.empty() || word.starts_with('-') || word == kDescribe) return "";
  std::vector<std::string> names;
  for (const Command& command : kCommands) {
    if (command.name == word) return "";
    names.emplace_back(command.name);
  }
  const std::string meant = touchdown::core::Nearest(word, names);
  return "there is no command '" + std::string(word) + "'; " +
         (meant.empty() ? "`touchdown --help` lists them"
                        : "did you mean `touchdown " + meant + "`?");
}

// The command line as CLI11 takes it: in reverse.
std::vector<std::string> Arguments(int argc, char** argv, const CLI::App& app) {
  std::vector<std::string> out = touchdown::cli::WithDefaults(
      {argv + 1, argv + argc}, app, touchdown::cli::ReadDefaults(""));
  std::reverse(out.begin(), out.end());
  return out;
}

// Where LAPACK is OpenBLAS, OpenCV brings a thread for each further core that
// waits busily for the first thirtieth of a second, in which most of a short
// command is done: 0.03 of 0.16 s (analyze, 1000 raw frames, two cores). What
// needs them starts them again.
void StopIdleThreads() {
  using Stop = int (*)();
  if (auto* const stop = reinterpret_cast<Stop>(
          ::dlsym(RTLD_DEFAULT, "blas_thread_shutdown_"))) {
    stop();
  }
}

// What was asked of which program.
void JournalStart(int argc, char** argv) {
  namespace pipeline = touchdown::pipeline;
  if (!pipeline::JournalIsKept()) return;
  std::string line = "touchdown " + std::string(pipeline::Version()) + " (" +
                     std::string(pipeline::Commit()) + "):";
  for (int i = 1; i < argc; ++i) line += " " + std::string(argv[i]);
  pipeline::Journal(line);
}

int Complain(int status, const std::exception& error) {
  touchdown::pipeline::Journal("ended with status " + std::to_string(status) +
                               ": " + error.what());
  touchdown::cli::Tell(error.what());
  return status;
}

// Runs what the command line asks for; its results have arrived when it
// returns.
int Run(const touchdown::cli::Action& action) {
  const int status = action ? action() : 0;
  touchdown::cli::RequireStdoutWritten();
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  if (const auto status = touchdown::vision::ServeAsReader(argc, argv)) {
    return *status;
  }
  touchdown::cli::KeepStandardStreams();
  StopIdleThreads();
  touchdown::cli::CatchInterruptions();
  // A file that may not grow is an error of the write, not the end.
  std::signal(SIGXFSZ, SIG_IGN);

  CLI::App app{"At what angle did it touch down, and did it slide or bounce?",
               "touchdown"};
  app.set_version_flag("--version",
                       std::string(touchdown::pipeline::Version()) + " (" +
                           std::string(touchdown::pipeline::Commit()) + ")");
  // Until it is known who listens nobody does.
  touchdown::cli::SetUpLog({});
  touchdown::cli::LogFlags log;
  touchdown::cli::AddLogFlags(app, log);
  app.fallthrough();
  app.require_subcommand(1);
  touchdown::cli::Action action;
  AddCommands(app, action, argc > 1 ? argv[1] : "");
  // Not of each command: what is set before them they take over.
  app.footer(
      "Exit status: 0 done (an undecided trial is a result); 2 wrong usage or "
      "impossible argument; 3 input unreadable, damaged or unsupported; 4 "
      "trouble with the trial store; 5 a batch finished with some recordings "
      "failed; 6 output could not be written; 130 or 143 ended by Ctrl-C or "
      "SIGTERM.");
  try {
    if (const std::string unknown = UnknownCommand(argc > 1 ? argv[1] : "");
        !unknown.empty()) {
      throw std::invalid_argument(unknown);
    }
    app.parse(Arguments(argc, argv, app));
    touchdown::cli::SetUpLog(log);
    JournalStart(argc, argv);
    return Run(action);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) return Complain(kUsage, error);
    app.exit(error);  // --help, --version
    try {
      return Run({});
    } catch (const touchdown::core::OutputError& trouble) {
      return Complain(kOutput, trouble);
    }
  } catch (const std::invalid_argument& error) {
    return Complain(kUsage, error);
  } catch (const touchdown::core::OutputError& error) {
    return Complain(kOutput, error);
  } catch (const touchdown::core::InputError& error) {
    return Complain(kInput, error);
  } catch (const touchdown::core::StoreError& error) {
    return Complain(kStore, error);
  } catch (const std::bad_alloc&) {
    touchdown::cli::Tell(
        "out of memory; a smaller clip, fewer --jobs or a higher limit");
    return kInput;
  } catch (const std::exception& error) {
    // What fmt throws where stdout takes no more.
    if (std::ferror(stdout) != 0) {
      touchdown::cli::Tell(std::string("stdout: the results could not be "
                                       "written: ") +
                           error.what());
      return kOutput;
    }
    return Complain(kDefect, error);
  }
}
