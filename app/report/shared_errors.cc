#include "app/report/shared_errors.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <string_view>

#include "app/facts/analysis_facts.h"

namespace touchdown::report {
namespace {

// Lines of a budget that the set-up brings with it.
constexpr std::string_view kOfTheSetUp[] = {"level", "lens", "yaw", "scale",
                                            "common"};

// What AnalysisSources() says of one trial under `name`; empty where it says
// nothing.
std::string Source(const std::vector<NameValue>& sources,
                   std::string_view name) {
  for (const auto& [what, value] : sources) {
    if (what == name) return value;
  }
  return "";
}

// Whether a line of the budget is common to the trials of a set-up. A ground
// line that a person or a calibration gave is the same wrong line in every
// clip; one that was found in the clip is found anew.
bool IsOfTheSetUp(const core::BudgetLine& line, const std::string& ground) {
  if (line.source == "ground") {
    return ground.starts_with("calibration") || ground.starts_with("user");
  }
  return std::find(std::begin(kOfTheSetUp), std::end(kOfTheSetUp),
                   line.source) != std::end(kOfTheSetUp);
}

}  // namespace

void ShareErrors(std::span<const core::Trial> trials,
                 std::vector<analysis::Observation>& observations) {
  // Set-ups are numbered as they are met.
  std::map<std::string, int> setups;
  for (analysis::Observation& o : observations) {
    const core::Trial& trial = trials[o.trial];
    // Nothing is known of its u: the whole of it stays the trial's own.
    if (AngleBudget(trial).empty()) continue;
    const auto sources = AnalysisSources(trial);
    // The calibration as the analysis document describes it, or the entry of
    // the register that the trial was logged with: its id tells two versions of
    // one calibration apart.
    std::string setup = Source(sources, "calibration");
    if (trial.conditions && !trial.conditions->calibration.name.empty()) {
      setup = trial.conditions->calibration.name + "\n" +
              trial.conditions->calibration.id;
    }
    o.setup =
        setups.emplace(setup, static_cast<int>(setups.size())).first->second;
    const std::string ground = Source(sources, "ground line from");
    // Parts of an uncertainty add and subtract in squares.
    double common = 0.0;
    for (const core::BudgetLine& line : AngleBudget(trial)) {
      if (IsOfTheSetUp(line, ground)) common += line.u * line.u;
    }
    // A budget may be older than a u that a person stated.
    common = std::min(common, o.u_rad * o.u_rad);
    o.common_u_rad = std::sqrt(common);
    o.u_rad = std::sqrt(o.u_rad * o.u_rad - common);
  }
}

}  // namespace touchdown::report
