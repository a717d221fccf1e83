#include "app/report/set_points.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "app/report/evidence_page.h"
#include "app/text/format.h"
#include "touchdown/analysis/statistics/agreement_statistics.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;
using Members = std::span<const std::size_t>;

// E_n of a measured value against an expected one, with expanded uncertainties
// (k = 2): "+0.42". Without any uncertainty there is no such number.
std::string ErrorNumber(const core::Estimate& measured,
                        const core::Estimate& expected) {
  if (!(measured.u > 0.0) && !(expected.u > 0.0)) return "u = 0";
  return Signed(analysis::NormalizedError(measured.value, 2 * measured.u,
                                          expected.value, 2 * expected.u),
                2);
}

// Empty where one of the two is absent.
std::string ErrorNumber(const core::Measured& measured,
                        const core::Measured& expected) {
  return measured && expected ? ErrorNumber(*measured, *expected) : "";
}

// The trials with set-points: angle in degrees and, where one has it, launch
// speed in m/s, each beside what was measured. Without E_n: it counts both
// uncertainties, and the setting's is the rig's, not in a trial.
// MakePredictionTable() has it.
Table MakeSetTable(Members members, std::span<const core::Trial> trials,
                   const ReportInput& input) {
  const bool with_speed = std::any_of(
      members.begin(), members.end(),
      [&](std::size_t t) { return trials[t].set_speed_mps.has_value(); });
  Table table{
      "Set-points beside measurement",
      {{"set angle (deg)", true},
       {fmt::format("measured minus set {} u (deg)", kPlusMinus), true}},
      {}};
  if (with_speed) {
    table.columns.push_back({"set launch speed (m/s)", true});
    table.columns.push_back(
        {fmt::format("speed at touchdown {} u (m/s)", kPlusMinus), true});
  }
  table.columns.push_back({"clip or trial"});
  for (const std::size_t t : members) {
    const core::Trial& trial = trials[t];
    // A trial without set-points has no row.
    if (!trial.set_angle_rad && !trial.set_speed_mps) continue;
    std::vector<Cell> row(2);
    const core::Measured angle = core::ContactAngle(trial);
    if (trial.set_angle_rad) {
      row[0].text = Plain(*trial.set_angle_rad / kDegree);
      if (angle) {
        // A set-point has no uncertainty here: the difference has the angle's.
        row[1].text = DifferenceWithU(
            {angle->value - *trial.set_angle_rad, angle->u, {}}, kDegree);
      }
    }
    if (with_speed) {
      row.push_back({trial.set_speed_mps ? Plain(*trial.set_speed_mps, 3)
                                         : std::string()});
      row.push_back({WithUOrReason(trial.first.motion.before_speed_mps, 1.0)});
    }
    row.push_back(TrialCell(trial, input));
    table.rows.push_back(std::move(row));
  }
  return table;
}

// What the rig's description predicts for the set-points, beside what was
// measured, with the uncertainty of both sides in E_n. Without rows where no
// rig was given.
Table MakePredictionTable(Members members, std::span<const core::Trial> trials,
                          const ReportInput& input) {
  const std::string u = fmt::format(" {} u ", kPlusMinus);
  Table table{"What the rig should do, and what was measured",
              {{"predicted launch speed" + u + "(m/s)", true},
               {"measured" + u + "(m/s)", true},
               {"E_n", true},
               {"predicted approach angle" + u + "(deg)", true},
               {"measured" + u + "(deg)", true},
               {"E_n", true},
               {"clip or trial"}},
              {}};
  for (const std::size_t t : members) {
    const core::Trial& trial = trials[t];
    const auto found = input.rig.predictions.find(trial.id);
    if (found == input.rig.predictions.end()) continue;
    const ShotPrediction& p = found->second;
    if (!p.launch_speed_mps && !p.approach_angle_rad) continue;
    // The rig predicts the approach angle, whatever angle is the contact angle.
    const core::Measured& angle = trial.first.contact.approach_angle_rad;
    table.rows.push_back(
        {{WithUOrReason(p.launch_speed_mps, 1.0)},
         {WithUOrReason(p.measured_launch_speed_mps, 1.0)},
         {ErrorNumber(p.measured_launch_speed_mps, p.launch_speed_mps)},
         {WithUOrReason(p.approach_angle_rad, kDegree)},
         {WithUOrReason(angle, kDegree)},
         {ErrorNumber(angle, p.approach_angle_rad)},
         TrialCell(trial, input)});
  }
  return table;
}

// Why some trials have no prediction: "no set-point of the launch speed (9
// trials)". Empty where all have one.
std::string WhyNotPredicted(Members members,
                            std::span<const core::Trial> trials,
                            const ReportInput& input) {
  std::map<std::string, int> reasons;
  for (const std::size_t t : members) {
    const auto found = input.rig.predictions.find(trials[t].id);
    if (found == input.rig.predictions.end()) continue;
    const core::Measured& speed = found->second.launch_speed_mps;
    if (!speed) ++reasons[speed.error().reason];
  }
  // Every trial's own page has its reason; here the first tell what they are.
  constexpr std::size_t kShown = 2;
  std::string out;
  std::size_t shown = 0;
  int others = 0;
  for (const auto& [reason, n] : reasons) {
    if (++shown > kShown) {
      others += n;
      continue;
    }
    out += fmt::format("{}{} ({} trial{})", out.empty() ? "" : "; ", reason, n,
                       n == 1 ? "" : "s");
  }
  if (others > 0) {
    out += fmt::format("; for other reasons of this kind {} more", others);
  }
  return out;
}

// Both tables with their remarks, for a group or for one trial; nothing where
// no trial has a set-point.
std::vector<Block> MakeSetPointTables(Members members,
                                      std::span<const core::Trial> trials,
                                      const ReportInput& input) {
  std::vector<Block> out;
  Table set = MakeSetTable(members, trials, input);
  if (set.rows.empty()) return out;
  out.emplace_back(std::move(set));
  Table predicted = MakePredictionTable(members, trials, input);
  if (!predicted.rows.empty()) {
    out.emplace_back(std::move(predicted));
    out.emplace_back(Paragraph{
        "Predicted from the rig's description for these set-points. The "
        "measured launch speed is the speed at touchdown less what the fall "
        "from the muzzle added. E_n carries the expanded uncertainties of both "
        "sides; |E_n| up to 1 is compatible.",
        true});
  }
  const std::string why = WhyNotPredicted(members, trials, input);
  if (!why.empty()) {
    out.emplace_back(Paragraph{"No prediction of the rig: " + why + ".", true});
  }
  return out;
}

// Mean and root mean square of measured minus set angle, in degrees, over the
// trials that count: the mean is the ejector's offset. Empty where none was
// set.
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
      "Measured minus set angle over {} trials: mean {} deg, root mean square "
      "{:.3f} deg.",
      n, Signed(sum / n, 3), std::sqrt(squares / n));
}

}  // namespace

std::string TrialName(const core::Trial& trial) {
  // The first eight characters of a UUID tell the trials of a store apart;
  // other names ("line 12") are shown whole.
  constexpr std::size_t kUuidLength = 36;
  constexpr std::size_t kShown = 8;
  if (!trial.clip.path.empty()) {
    return std::filesystem::path(trial.clip.path).filename().string();
  }
  return trial.id.substr(
      0, trial.id.size() == kUuidLength ? kShown : std::string::npos);
}

Cell TrialCell(const core::Trial& trial, const ReportInput& input) {
  return {TrialName(trial), Tone::kMuted, EvidenceLink(input, trial)};
}

std::vector<Block> MakeSetPoints(const Group& group,
                                 std::span<const core::Trial> trials,
                                 const ReportInput& input) {
  std::vector<Block> out = MakeSetPointTables(group.members, trials, input);
  if (out.empty()) return out;
  const std::string summary = SetPointText(group);
  if (!summary.empty()) out.emplace_back(Paragraph{summary, true});
  const bool with_speed = std::any_of(
      group.members.begin(), group.members.end(),
      [&](std::size_t t) { return trials[t].set_speed_mps.has_value(); });
  if (with_speed && input.rig.facts.empty()) {
    out.emplace_back(Paragraph{
        "The set speed is that of the launch; the measured one is at "
        "touchdown, faster by the fall from the muzzle. With --rig RIG.toml "
        "the report compares launch speeds, with E_n.",
        true});
  }
  return out;
}

std::vector<Block> MakeTrialSetPoints(const core::Trial& trial,
                                      const ReportInput& input) {
  const std::size_t only = 0;
  return MakeSetPointTables({&only, 1}, {&trial, 1}, input);
}

}  // namespace touchdown::report
