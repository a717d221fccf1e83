// table1.tex: Table 1 to \input into a paper. One tabular environment for each
// part of the table, without a float around it, so that caption and place are
// the author's.
#include <fmt/core.h>

#include "app/report/content.h"
#include "app/text/text.h"

namespace touchdown::report {

std::string MakeLatex(std::span<const Group> groups,
                      std::span<const core::Trial> trials,
                      const ReportInput& input) {
  std::string out = "% Needs nothing beyond LaTeX itself.\n";
  // A table for each origin: they are never pooled.
  for (const core::Origin origin :
       {core::Origin::kRecorded, core::Origin::kManual,
        core::Origin::kSimulated}) {
    std::vector<Group> same;
    for (const Group& group : groups) {
      if (group.trials.origin == origin) same.push_back(group);
    }
    if (same.empty()) continue;
    for (const Table& table : MakeTable1(same, trials, input)) {
      if (origin == core::Origin::kSimulated) {
        out += fmt::format("% {}\n", kWatermark);
      }
      out += "\\begin{tabular}{";
      for (const Column& column : table.columns) {
        out += column.numeric ? 'r' : 'l';
      }
      out += "}\n\\hline\n";
      // One row: escaped cells with & between them. `text_of` gives the text of
      // a cell.
      const auto write = [&](const auto& cells, const auto& text_of) {
        bool first = true;
        for (const auto& cell : cells) {
          if (!first) out += " & ";
          first = false;
          out += LatexEscape(text_of(cell));
        }
        out += " \\\\\n";
      };
      write(table.columns, [](const Column& c) { return c.heading; });
      out += "\\hline\n";
      for (const auto& row : table.rows) {
        write(row, [](const Cell& c) { return c.text; });
      }
      out += "\\hline\n";
      if (origin == core::Origin::kSimulated) {
        // The watermark is a row of the table itself, so that it goes with it
        // into the paper.
        out += fmt::format("\\multicolumn{{{}}}{{l}}{{\\textbf{{{}}}}} \\\\\n",
                           table.columns.size(), LatexEscape(kWatermark));
      }
      out += "\\end{tabular}\n";
    }
  }
  return out;
}

}  // namespace touchdown::report
