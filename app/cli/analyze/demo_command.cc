// touchdown demo: renders the clips of Table 1, analyses and logs them, writes
// the report, and prints each answer beside the truth it was rendered from.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include "app/cli/analyze/analyze_flags.h"
#include "app/cli/command.h"
#include "app/cli/options.h"
#include "app/cli/progress.h"
#include "app/demo/demo.h"
#include "app/report/group.h"
#include "touchdown/core/units.h"

namespace touchdown::cli {
namespace {

// Holds the flags as typed. The same seed gives the same clips.
struct DemoFlags {
  std::string out = "touchdown-demo";
  std::uint64_t seed = 1;
  double limit_s = pipeline::kUsualLimit_s;
};

// Runs the whole chain and prints a table with a row for each clip. Returns 0
// even where an answer is wrong: the table marks that row.
int RunDemo(const DemoFlags& flags) {
  pipeline::DemoOptions options;
  options.folder = flags.out;
  options.seed = flags.seed;
  options.limit_s = ToLimit(flags.limit_s);
  ProgressBar bar("demo");
  options.progress = [&bar](double share, const std::string&) {
    bar.Show(share);
  };
  const pipeline::DemoResult demo = pipeline::RunDemo(options);
  bar.Finish();
  fmt::print(
      "Table 1 on rendered clips (SIMULATED); \"slide\" is every trial that "
      "does not bounce\n\n"
      "{:<26} {:>9} {:>20} {:>9} {:>9} {:>9}\n",
      "clip", "true/deg", "measured/deg", "error/deg", "true", "measured");
  for (const pipeline::DemoRow& row : demo.rows) {
    std::string measured = "absent";
    std::string error;
    // A face angle has a sign; the contact angle of a face campaign is its
    // magnitude.
    if (row.angle_rad) {
      const double value = std::abs(row.angle_rad->value) / core::kDegree;
      measured = fmt::format("{:.3f} +- {:.3f}", value,
                             row.angle_rad->u / core::kDegree);
      error =
          fmt::format("{:+.3f}", value - row.true_angle_rad / core::kDegree);
    }
    fmt::print("{:<26} {:>9.1f} {:>20} {:>9} {:>9} {:>9}{}\n", row.clip,
               row.true_angle_rad / core::kDegree, measured, error,
               report::PaperWord(row.true_state), report::PaperWord(row.state),
               row.right() ? "" : "  WRONG");
  }
  // The paths are absolute, so that they can be opened from any folder.
  fmt::print(
      "\n{} of {} right as bounce or not; RMSE of the contact angle {:.4f} deg "
      "over {} clips\nreport     {}\nstore      {}\n",
      demo.right, demo.rows.size(), demo.rmse_rad / core::kDegree, demo.angles,
      std::filesystem::absolute(demo.report).lexically_normal().string(),
      std::filesystem::absolute(demo.store).lexically_normal().string());
  return 0;
}

}  // namespace

void AddDemo(CLI::App& app, Action& action) {
  auto flags = std::make_shared<DemoFlags>();
  CLI::App* command = AddCommand(
      app, "demo", "Table 1, end to end, on rendered clips with known truth");
  AddOption(*command, "--out", flags->out,
            "folder for clips, evidence, store and report")
      .ShowDefault();
  AddOption(*command, "--seed", flags->seed, "of the clips' noise")
      .ShowDefault();
  AddLimitFlag(*command, flags->limit_s);
  SetAction(*command, action, [flags] { return RunDemo(*flags); });
}

}  // namespace touchdown::cli
