// table1.csv: one line a trial, units in the heading.
#include <fmt/core.h>

#include <map>
#include <optional>

#include "app/report/content.h"
#include "app/report/text.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;
using core::kMillimetre;

std::string Number(const std::optional<double>& value) {
  return value ? fmt::format("{:.6g}", *value) : "";
}

std::string Value(const core::Measured& m, double unit) {
  return m ? fmt::format("{:.6g}", m->value / unit) : "";
}

std::string U(const core::Measured& m, double unit) {
  return m ? fmt::format("{:.3g}", m->u / unit) : "";
}

std::map<std::size_t, std::string> ReasonsLeftOut(const Group& group) {
  std::map<std::size_t, std::string> out;
  for (const auto& left : group.trials.left_out) {
    out[left.trial] = left.reason;
  }
  return out;
}

}  // namespace

std::string MakeCsv(std::span<const Group> groups,
                    std::span<const core::Trial> trials) {
  std::string out =
      "campaign,origin,watermark,body,surface,angle_kind,set_angle_deg,"
      "angle_deg,u_angle_deg,state,paper_word,p_bounce,max_gap_mm,"
      "u_max_gap_mm,bounce_height_mm,micro_bounce,left_out,clip,trial,"
      "revision,extrapolated_gap_mm,u_extrapolated_gap_mm,state_because\r\n";
  for (const Group& group : groups) {
    const auto left_out = ReasonsLeftOut(group);
    for (const std::size_t t : group.members) {
      const auto why = left_out.find(t);
      const core::Trial& trial = trials[t];
      const core::StateDecision& state = trial.first.state;
      const core::Measured& angle = core::ContactAngle(trial);
      std::optional<double> set_deg;
      if (trial.set_angle_rad) set_deg = *trial.set_angle_rad / kDegree;
      const std::string cells[] = {trial.campaign,
                                   std::string(core::Name(trial.origin)),
                                   group.simulated() ? "SIMULATED" : "",
                                   std::string(core::Name(trial.body.kind)),
                                   group.campaign.surface,
                                   std::string(core::Name(trial.angle_kind)),
                                   Number(set_deg),
                                   Value(angle, kDegree),
                                   U(angle, kDegree),
                                   std::string(core::Name(state.label)),
                                   PaperWord(state.label),
                                   Number(state.p_bounce),
                                   Value(state.max_gap_m, kMillimetre),
                                   U(state.max_gap_m, kMillimetre),
                                   Value(state.bounce_height_m, kMillimetre),
                                   state.micro_bounce ? "1" : "0",
                                   why == left_out.end() ? "" : why->second,
                                   trial.clip.path,
                                   trial.id,
                                   fmt::format("{}", trial.revision),
                                   Value(state.extrapolated_gap_m, kMillimetre),
                                   U(state.extrapolated_gap_m, kMillimetre),
                                   state.reason};
      for (std::size_t i = 0; i < std::size(cells); ++i) {
        if (i > 0) out += ',';
        out += CsvCell(cells[i]);
      }
      out += "\r\n";
    }
  }
  return out;
}

}  // namespace touchdown::report
