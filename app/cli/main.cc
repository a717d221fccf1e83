// This is the program's entry: it leads from the command line to one function,
// and from what that throws to the exit status. The order at the start matters:
// a process that was started as a reader of recordings goes no further; the
// standard streams come before any file is opened, the signals before any
// thread is started.
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

// main itself returns these; 5 and other statuses come from the commands.
enum ExitStatus : int {
  kUsage = 2,   // wrong usage or impossible argument
  kInput = 3,   // input unreadable, damaged or unsupported
  kStore = 4,   // trial store trouble
  kOutput = 6,  // output could not be written
  kDefect = 70
};

// Holds a command's name and the function that adds it to the command line.
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

// This is a tool of the build, which writes manual pages of all commands. No
// user needs it, and --help leaves it out.
constexpr std::string_view kDescribe = "describe";

// Adds the command of that name alone, since making all of them takes
// milliseconds of every start. Where the name is no command (--help, --verbose
// before the command, a misspelt word), all are added.
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

// Returns the message for a first word that is no command, with the one that
// was probably meant; empty where it is a command or an option. CLI11's own
// message would not name what was meant.
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

// Returns the arguments with the defaults of touchdown.toml added, last first:
// in this order CLI11 takes a vector. Throws core::InputError where the line
// needs that file and it cannot be understood.
std::vector<std::string> Arguments(int argc, char** argv, const CLI::App& app) {
  std::vector<std::string> out =
      touchdown::cli::WithDefaults({argv + 1, argv + argc}, app, "");
  std::reverse(out.begin(), out.end());
  return out;
}

// Where LAPACK is OpenBLAS, it starts with a thread for each further core. Each
// waits busily for the first thirtieth of a second, in which a short command
// does most of its work: 0.03 of 0.16 s (analyze, 1000 raw frames, two cores).
// They are stopped here; OpenBLAS starts them again when they are needed.
void StopIdleThreads() {
  using Stop = int (*)();
  if (auto* const stop = reinterpret_cast<Stop>(
          ::dlsym(RTLD_DEFAULT, "blas_thread_shutdown_"))) {
    stop();
  }
}

// Writes version, commit and command line to the journal, so that a log says
// what was asked of which program.
void JournalStart(int argc, char** argv) {
  namespace pipeline = touchdown::pipeline;
  if (!pipeline::JournalIsKept()) return;
  std::string line = "touchdown " + std::string(pipeline::Version()) + " (" +
                     std::string(pipeline::Commit()) + "):";
  for (int i = 1; i < argc; ++i) line += " " + std::string(argv[i]);
  pipeline::Journal(line);
}

// Says the error on stderr and in the journal; returns `status`.
int Complain(int status, const std::exception& error) {
  touchdown::pipeline::Journal("ended with status " + std::to_string(status) +
                               ": " + error.what());
  touchdown::cli::Tell(error.what());
  return status;
}

// Runs the command and returns its exit status. Throws core::OutputError where
// its results did not all arrive on stdout. An empty action (--help) is 0.
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
  // A closed stdout would otherwise be the number of the next file opened, and
  // results would be written into it.
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
  // The flags are not read yet; until they are, the journal goes nowhere.
  touchdown::cli::SetUpLog({});
  touchdown::cli::LogFlags log;
  touchdown::cli::AddLogFlags(app, log);
  // Options of the program are understood behind a command's name, too.
  app.fallthrough();
  app.require_subcommand(1);
  touchdown::cli::Action action;
  AddCommands(app, action, argc > 1 ? argv[1] : "");
  // A command takes over the footer that is set before it is added. This footer
  // belongs to the program's own help alone, so it comes last.
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
    // Only the parsed line says where the journal goes; its first entry
    // follows.
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
    // An OutputError is an InputError as well: caught first, it keeps its own
    // status.
    return Complain(kOutput, error);
  } catch (const touchdown::core::InputError& error) {
    return Complain(kInput, error);
  } catch (const touchdown::core::StoreError& error) {
    return Complain(kStore, error);
  } catch (const std::bad_alloc&) {
    // There may be no memory left to make a message: this one is short and
    // fixed.
    touchdown::cli::Tell(
        "out of memory; a smaller clip, fewer --jobs or a higher limit");
    return kInput;
  } catch (const std::exception& error) {
    // fmt throws this where stdout takes no more.
    if (std::ferror(stdout) != 0) {
      touchdown::cli::Tell(std::string("stdout: the results could not be "
                                       "written: ") +
                           error.what());
      return kOutput;
    }
    return Complain(kDefect, error);
  }
}
