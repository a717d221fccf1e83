// How a command joins the program.
#pragma once

#include <functional>

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace touchdown::cli {

// What main runs after the command line has been read; returns the exit status:
// 0 done; 5 a batch finished with some clips failed. Trouble is thrown:
// std::invalid_argument (exit 2), core::InputError (3), core::StoreError (4),
// core::OutputError (6).
using Action = std::function<int()>;

// Each Add...() adds one command with its flags to `app`, and sets `action`
// when that command is the one called.
void AddAnalyze(CLI::App& app, Action& action);
void AddBatch(CLI::App& app, Action& action);
void AddBoundary(CLI::App& app, Action& action);
void AddCalibrate(CLI::App& app, Action& action);
void AddNext(CLI::App& app, Action& action);
void AddRegister(CLI::App& app, Action& action);
void AddReport(CLI::App& app, Action& action);
void AddReview(CLI::App& app, Action& action);
void AddRig(CLI::App& app, Action& action);
void AddSession(CLI::App& app, Action& action);
void AddSimulate(CLI::App& app, Action& action);
void AddTheory(CLI::App& app, Action& action);
void AddList(CLI::App& app, Action& action);
void AddShow(CLI::App& app, Action& action);
void AddLog(CLI::App& app, Action& action);
void AddCorrect(CLI::App& app, Action& action);
void AddCampaign(CLI::App& app, Action& action);
void AddExport(CLI::App& app, Action& action);
void AddImport(CLI::App& app, Action& action);
void AddDemo(CLI::App& app, Action& action);
void AddDb(CLI::App& app, Action& action);
void AddDescribe(CLI::App& app, Action& action);
void AddDoctor(CLI::App& app, Action& action);
void AddReportBug(CLI::App& app, Action& action);

}  // namespace touchdown::cli
