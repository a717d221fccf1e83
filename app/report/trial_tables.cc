// Every trial of a group, with its set-points, and those left out.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "app/report/content.h"
#include "app/report/format.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;
using core::kMillimetre;

Cell StateCell(const core::StateDecision& state) {
  const std::string word = PaperWord(state.label);
  const Tone tone = word == "slide"    ? Tone::kSlide
                    : word == "bounce" ? Tone::kBounce
                                       : Tone::kUndecided;
  std::string text(core::Name(state.label));
  if (state.micro_bounce) text += " (micro-bounce)";
  return {text, tone};
}

Cell AgreesCell(const core::Trial& trial, const analysis::Observation* o,
                const analysis::TheoryComparison& theory) {
  if (o == nullptr) return {"left out", Tone::kMuted};
  if (o->outcome == analysis::Outcome::kUndecided) {
    return {"undecided", Tone::kUndecided};
  }
  const double boundary = theory.theory.boundary_rad;
  if (analysis::DecidesNothing(*o, boundary)) {
    return {"decides nothing", Tone::kMuted};
  }
  const bool bounced = trial.first.state.label == core::MotionState::kBounce;
  return (o->angle_rad > boundary) == bounced ? Cell{"yes", Tone::kGood}
                                              : Cell{"no", Tone::kBad};
}

// The clip's name; without a clip the beginning of the identity, which
// `touchdown show` takes and table1.csv has whole.
Cell TrialCell(const core::Trial& trial) {
  constexpr std::size_t kUuidLength = 36;
  constexpr std::size_t kShown = 8;
  if (!trial.clip.path.empty()) {
    return {std::filesystem::path(trial.clip.path).filename().string(),
            Tone::kMuted};
  }
  return {trial.id.substr(
              0, trial.id.size() == kUuidLength ? kShown : std::string::npos),
          Tone::kMuted};
}

Table MakeTrialTable(const Group& group, std::span<const core::Trial> trials) {
  Table table;
  table.caption = "Every trial";
  table.columns = {
      {"set (deg)", true},
      {fmt::format("{} {} u (deg)", AngleName(group), kPlusMinus), true},
      {"motion state"},
      {"paper's word"},
      {"P(bounce)", true},
      {fmt::format("greatest gap {} u (mm)", kPlusMinus), true}};
  const analysis::TheoryComparison* theory =
      group.study.theories.empty() ? nullptr : &group.study.theories.front();
  if (theory != nullptr) {
    table.columns.push_back(
        {fmt::format("agrees with {} {} deg?", theory->theory.name,
                     Plain(theory->theory.boundary_rad / kDegree))});
  }
  table.columns.push_back({"clip or trial"});
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
    row.push_back({state.p_bounce ? Plain(*state.p_bounce, 4)
                                  : std::string("not filmed")});
    row.push_back({WithUOrReason(state.max_gap_m, kMillimetre)});
    if (theory != nullptr) {
      row.push_back(AgreesCell(
          trial, found == observed.end() ? nullptr : found->second, *theory));
    }
    row.push_back(TrialCell(trial));
    table.rows.push_back(std::move(row));
  }
  return table;
}

// Set-points beside measurement. E_n = (measured - set) / U with U = 2 u of the
// measurement: the setting's own uncertainty is the rig's, and not in a trial.
Table MakeSetPoints(const Group& group, std::span<const core::Trial> trials) {
  const bool with_speed = std::any_of(
      group.members.begin(), group.members.end(),
      [&](std::size_t t) { return trials[t].set_speed_mps.has_value(); });
  Table table{"Set-points beside measurement",
              {{"set angle (deg)", true},
               {"measured - set (deg)", true},
               {"E_n of the angle", true}},
              {}};
  if (with_speed) {
    table.columns.push_back({"set speed (m/s)", true});
    table.columns.push_back(
        {fmt::format("speed at touchdown {} u (m/s)", kPlusMinus), true});
  }
  table.columns.push_back({"clip or trial"});
  for (const std::size_t t : group.members) {
    const core::Trial& trial = trials[t];
    if (!trial.set_angle_rad && !trial.set_speed_mps) continue;
    std::vector<Cell> row(3);
    const core::Measured& angle = core::ContactAngle(trial);
    if (trial.set_angle_rad) {
      row[0].text = Plain(*trial.set_angle_rad / kDegree);
      if (angle) {
        const double off = angle->value - *trial.set_angle_rad;
        row[1].text = fmt::format("{:+.3f}", off / kDegree);
        row[2].text = angle->u > 0.0
                          ? fmt::format("{:+.2f}", off / (2 * angle->u))
                          : "u = 0";
      }
    }
    if (with_speed) {
      row.push_back({trial.set_speed_mps ? Plain(*trial.set_speed_mps, 3)
                                         : std::string()});
      row.push_back({WithUOrReason(trial.first.motion.before_speed_mps, 1.0)});
    }
    row.push_back(TrialCell(trial));
    table.rows.push_back(std::move(row));
  }
  return table;
}

// Mean and root mean square of measured minus set angle.
std::string SetPointText(const Group& group) {
  double sum = 0.0;
  double squares = 0.0;
  int n = 0;
  for (const auto& o : group.trials.observations) {
    if (!o.set_angle_rad) continue;
    const double error_deg = (o.angle_rad - *o.set_angle_rad) / kDegree;
    sum += error_deg;
    squares += error_deg * error_deg;
    ++n;
  }
  if (n == 0) return "";
  return fmt::format(
      "Measured minus set angle over {} trials: mean {:+.3f} deg, root mean "
      "square {:.3f} deg.",
      n, sum / n, std::sqrt(squares / n));
}

Table MakeLeftOut(const Group& group, std::span<const core::Trial> trials) {
  Table table{"Left out of the statistics", {{"trial"}, {"reason"}}, {}};
  for (const auto& left : group.trials.left_out) {
    table.rows.push_back({TrialCell(trials[left.trial]), {left.reason}});
  }
  return table;
}

}  // namespace

std::vector<Block> MakeTrialTables(const Group& group,
                                   std::span<const core::Trial> trials) {
  std::vector<Block> out;
  out.push_back(MakeTrialTable(group, trials));
  Table set_points = MakeSetPoints(group, trials);
  if (!set_points.rows.empty()) {
    out.push_back(std::move(set_points));
    const std::string summary = SetPointText(group);
    if (!summary.empty()) out.push_back(Paragraph{summary, true});
    if (std::any_of(group.members.begin(), group.members.end(),
                    [&](std::size_t t) {
                      return trials[t].set_speed_mps.has_value();
                    })) {
      out.push_back(Paragraph{
          "The set speed is that of the launch; the measured one is at "
          "touchdown, faster by the fall from a muzzle height that is not in "
          "a trial. So they have no E_n.",
          true});
    }
  }
  if (!group.trials.left_out.empty()) {
    out.push_back(MakeLeftOut(group, trials));
  }
  return out;
}

}  // namespace touchdown::report
