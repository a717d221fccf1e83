// table1.csv: one line a trial, units in the heading.
#include <fmt/core.h>

#include <algorithm>

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

std::string ReasonLeftOut(const Group& group, std::size_t trial) {
  for (const auto& left : group.trials.left_out) {
    if (left.trial == trial) return left.reason;
  }
  return "";
}

}  // namespace

std::string MakeCsv(std::span<const Group> groups,
                    std::span<const core::Trial> trials) {
  std::string out =
      "campaign,origin,watermark,body,surface,angle_kind,set_angle_deg,"
      "angle_deg,u_angle_deg,state,paper_word,p_bounce,max_gap_mm,"
      "u_max_gap_mm,bounce_height_mm,micro_bounce,left_out,clip,trial,"
      "revision\r\n";
  for (const Group& group : groups) {
    for (const std::size_t t : group.members) {
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
                                   ReasonLeftOut(group, t),
                                   trial.clip.path,
                                   trial.id,
                                   fmt::format("{}", trial.revision)};
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
