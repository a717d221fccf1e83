// Every trial of a group, with its set-points, and those left out.
#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "app/report/content.h"
#include "app/report/set_points.h"
#include "app/text/format.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;
using core::kMillimetre;

// The motion state in the program's own words, in the colour of the paper's
// word.
Cell StateCell(const core::StateDecision& state) {
  const std::string word = PaperWord(state.label);
  const Tone tone = word == "slide"    ? Tone::kSlide
                    : word == "bounce" ? Tone::kBounce
                                       : Tone::kUndecided;
  std::string text(core::Name(state.label));
  if (state.micro_bounce) text += " (micro-bounce)";
  return {text, tone};
}

// The greatest gap that was filmed, in mm; where the film ends too early, also
// what the flight would have reached.
std::string GapText(const core::StateDecision& state) {
  std::string text = WithUOrReason(state.max_gap_m, kMillimetre);
  if (state.extrapolated_gap_m) {
    text += ", would reach " + WithU(*state.extrapolated_gap_m, kMillimetre);
  }
  return text;
}

// Whether the outcome is what `theory` predicts at the measured angle: above
// its boundary bounce, else slide. "too near to tell" within 2 u of the
// boundary. `o` is null for a trial that the statistics leave out.
Cell AgreesCell(const core::Trial& trial, const analysis::Observation* o,
                const analysis::TheoryComparison& theory) {
  if (o == nullptr) return {"left out", Tone::kMuted};
  if (o->outcome == analysis::Outcome::kUndecided) {
    return {"undecided", Tone::kUndecided};
  }
  const double boundary = theory.theory.boundary_rad;
  if (analysis::DecidesNothing(*o, theory.theory)) {
    return {"too near to tell", Tone::kMuted};
  }
  const bool bounced = trial.first.state.label == core::MotionState::kBounce;
  return (o->angle_rad > boundary) == bounced ? Cell{"yes", Tone::kGood}
                                              : Cell{"no", Tone::kBad};
}

// One row for each trial of the group, those left out too.
Table MakeTrialTable(const Group& group, std::span<const core::Trial> trials,
                     const ReportInput& input) {
  Table table;
  table.caption = "Every trial";
  table.columns = {
      {"set (deg)", true},
      {fmt::format("{} {} u (deg)", AngleName(group), kPlusMinus), true},
      {"motion state"},
      {"paper's word"},
      {"P(bounce)", true},
      {fmt::format("greatest gap {} u (mm)", kPlusMinus), true}};
  // The declared theory, or the first published one.
  const analysis::TheoryComparison* theory =
      group.study.theories.empty() ? nullptr : &group.study.theories.front();
  if (theory != nullptr) {
    table.columns.push_back(
        {fmt::format("agrees with {} {} deg?", theory->theory.name,
                     Plain(theory->theory.boundary_rad / kDegree))});
  }
  table.columns.push_back({"clip or trial"});
  // By the trial's index.
  std::map<std::size_t, const analysis::Observation*> observed;
  for (const auto& o : group.trials.observations) observed[o.trial] = &o;
  for (const std::size_t t : group.members) {
    const core::Trial& trial = trials[t];
    const core::StateDecision& state = trial.first.state;
    const auto found = observed.find(t);
    std::vector<Cell> row;
    row.push_back({trial.set_angle_rad ? Plain(*trial.set_angle_rad / kDegree)
                                       : std::string()});
    row.push_back({WithUOrReason(core::ContactAngle(trial), kDegree)});
    row.push_back(StateCell(state));
    row.push_back({PaperWord(state.label)});
    row.push_back({state.p_bounce ? Probability(*state.p_bounce)
                                  : std::string("absent")});
    row.push_back({GapText(state)});
    if (theory != nullptr) {
      row.push_back(AgreesCell(
          trial, found == observed.end() ? nullptr : found->second, *theory));
    }
    row.push_back(TrialCell(trial, input));
    table.rows.push_back(std::move(row));
  }
  return table;
}

// The trials that the statistics leave out, each with its reason.
Table MakeLeftOut(const Group& group, std::span<const core::Trial> trials,
                  const ReportInput& input) {
  Table table{"Left out of the statistics", {{"trial"}, {"reason"}}, {}};
  for (const auto& left : group.trials.left_out) {
    table.rows.push_back({TrialCell(trials[left.trial], input), {left.reason}});
  }
  return table;
}

}  // namespace

std::vector<Block> MakeTrialTables(const Group& group,
                                   std::span<const core::Trial> trials,
                                   const ReportInput& input) {
  std::vector<Block> out;
  out.push_back(MakeTrialTable(group, trials, input));
  for (Block& block : MakeSetPoints(group, trials, input)) {
    out.push_back(std::move(block));
  }
  if (!group.trials.left_out.empty()) {
    out.push_back(MakeLeftOut(group, trials, input));
  }
  return out;
}

}  // namespace touchdown::report
