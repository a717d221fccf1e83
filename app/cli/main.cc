#include <fmt/core.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <stdexcept>

#include "app/cli/command.h"
#include "app/pipeline/version.h"
#include "touchdown/core/errors.h"

namespace {

enum ExitStatus : int {
  kUsage = 2,  // wrong usage or impossible argument
  kInput = 3,  // input unreadable, damaged or unsupported
  kStore = 4,  // trial store trouble
  kDefect = 70
};

int Complain(int status, const char* what) {
  fmt::print(stderr, "touchdown: {}\n", what);
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  // stdout carries results only.
  spdlog::set_default_logger(spdlog::stderr_color_mt("touchdown"));
  spdlog::set_pattern("touchdown: %^%l%$: %v");

  CLI::App app{"At what angle did it touch down, and did it slide or bounce?",
               "touchdown"};
  app.set_version_flag("--version",
                       std::string(touchdown::pipeline::Version()));
  app.require_subcommand(1);
  touchdown::cli::Action action;
  touchdown::cli::AddAnalyze(app, action);
  touchdown::cli::AddBatch(app, action);
  touchdown::cli::AddCalibrate(app, action);
  touchdown::cli::AddSimulate(app, action);
  touchdown::cli::AddBoundary(app, action);
  touchdown::cli::AddNext(app, action);
  touchdown::cli::AddReport(app, action);
  touchdown::cli::AddReview(app, action);
  touchdown::cli::AddList(app, action);
  touchdown::cli::AddShow(app, action);
  touchdown::cli::AddLog(app, action);
  touchdown::cli::AddCorrect(app, action);
  touchdown::cli::AddCampaign(app, action);
  touchdown::cli::AddRegister(app, action);
  touchdown::cli::AddImport(app, action);
  touchdown::cli::AddExport(app, action);
  touchdown::cli::AddDb(app, action);
  touchdown::cli::AddSession(app, action);
  touchdown::cli::AddRig(app, action);
  touchdown::cli::AddTheory(app, action);
  touchdown::cli::AddDemo(app, action);
  try {
    app.parse(argc, argv);
    return action ? action() : 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    return Complain(kUsage, error.what());
  } catch (const std::invalid_argument& error) {
    return Complain(kUsage, error.what());
  } catch (const touchdown::core::InputError& error) {
    return Complain(kInput, error.what());
  } catch (const touchdown::core::StoreError& error) {
    return Complain(kStore, error.what());
  } catch (const std::exception& error) {
    return Complain(kDefect, error.what());
  }
}
