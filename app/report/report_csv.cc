// table1.csv: one line a trial, units in the heading; and its schema.
#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "app/report/content.h"
#include "app/text/json.h"
#include "app/text/text.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;
using core::kMillimetre;

// A column of table1.csv and of its schema.
struct CsvField {
  const char* name;
  const char* type;  // of XML Schema
  const char* unit;  // "" where there is none
  const char* meaning;
};
// The order is that of the file; a column is added at the end.
constexpr CsvField kCsvFields[] = {
    {"campaign", "string", "", "name of the campaign"},
    {"origin", "string", "", "recorded, simulated or manual; never pooled"},
    {"watermark", "string", "", "SIMULATED, or empty"},
    {"body", "string", "", "sphere or rectangle"},
    {"surface", "string", "", "of the campaign"},
    {"angle_kind", "string", "", "approach, radius or face"},
    {"set_angle_deg", "decimal", "deg", "set-point of the varied angle"},
    {"angle_deg", "decimal", "deg", "contact angle, of that kind"},
    {"u_angle_deg", "decimal", "deg", "its standard uncertainty"},
    {"state", "string", "", "motion state"},
    {"paper_word", "string", "", "slide (not a bounce), bounce or undecided"},
    {"p_bounce", "decimal", "", "probability of a bounce"},
    {"max_gap_mm", "decimal", "mm", "greatest gap after release"},
    {"u_max_gap_mm", "decimal", "mm", "its standard uncertainty"},
    {"bounce_height_mm", "decimal", "mm", "rising above it is a bounce"},
    {"micro_bounce", "string", "", "left the ground without reaching it"},
    {"left_out", "string", "", "why the statistics leave the trial out"},
    {"clip", "string", "", "path of the recording"},
    {"trial", "string", "", "identity of the trial"},
    {"revision", "integer", "", "of the statement about it, from 1"},
    {"extrapolated_gap_mm", "decimal", "mm",
     "that a flight would reach that the film cuts off"},
    {"u_extrapolated_gap_mm", "decimal", "mm", "its standard uncertainty"},
    {"state_because", "string", "", "the reason of the state"}};

std::string NumberText(const std::optional<double>& value) {
  return value ? fmt::format("{:.6g}", *value) : "";
}

// Value and u as cells: `unit` is the size of the column's unit in SI. Empty
// where the quantity is absent. Six digits for the value, three for its u.
std::string ValueText(const core::Measured& m, double unit) {
  return m ? fmt::format("{:.6g}", m->value / unit) : "";
}

std::string UncertaintyText(const core::Measured& m, double unit) {
  return m ? fmt::format("{:.3g}", m->u / unit) : "";
}

}  // namespace

std::string MakeCsv(std::span<const Group> groups,
                    std::span<const core::Trial> trials) {
  std::string out;
  for (const CsvField& field : kCsvFields) {
    out += (out.empty() ? "" : ",") + std::string(field.name);
  }
  out += "\r\n";
  // In the order of the groups and of their tables. Trials in no group (check
  // shots) have no line.
  for (const Group& group : groups) {
    const auto left_out = ReasonsLeftOut(group);
    for (const std::size_t t : group.members) {
      const auto why = left_out.find(t);
      const core::Trial& trial = trials[t];
      const core::StateDecision& state = trial.first.state;
      const core::Measured angle = core::ContactAngle(trial);
      std::optional<double> set_deg;
      if (trial.set_angle_rad) set_deg = *trial.set_angle_rad / kDegree;
      // One cell for each of kCsvFields, in its order.
      const std::string cells[] = {
          trial.campaign,
          std::string(core::Name(trial.origin)),
          group.simulated() ? "SIMULATED" : "",
          std::string(core::Name(trial.body.kind)),
          group.campaign.surface,
          std::string(core::Name(trial.angle_kind)),
          NumberText(set_deg),
          ValueText(angle, kDegree),
          UncertaintyText(angle, kDegree),
          std::string(core::Name(state.label)),
          PaperWord(state.label),
          NumberText(state.p_bounce),
          ValueText(state.max_gap_m, kMillimetre),
          UncertaintyText(state.max_gap_m, kMillimetre),
          ValueText(state.bounce_height_m, kMillimetre),
          state.micro_bounce ? "1" : "0",
          why == left_out.end() ? "" : why->second,
          trial.clip.path,
          trial.id,
          fmt::format("{}", trial.revision),
          ValueText(state.extrapolated_gap_m, kMillimetre),
          UncertaintyText(state.extrapolated_gap_m, kMillimetre),
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

// Metadata in the W3C's vocabulary for tabular data on the web (CSVW), so that
// a program can read the columns without a person.
std::string CsvSchema() {
  Json columns = Json::array();
  for (const CsvField& field : kCsvFields) {
    Json column = {{"name", field.name},
                   {"titles", field.name},
                   {"dc:description", field.meaning},
                   {"datatype", field.type}};
    if (*field.unit != '\0') column["schema:unitText"] = field.unit;
    columns.push_back(std::move(column));
  }
  const Json schema = {{"@context", "http://www.w3.org/ns/csvw"},
                       {"url", "table1.csv"},
                       {"dc:title", "one row a trial; empty cells are absent"},
                       {"tableSchema", {{"columns", std::move(columns)}}}};
  return schema.dump(1) + "\n";
}

}  // namespace touchdown::report
