// The evidence for a group's trials: the two labels of those that a person
// revised, the budget of their angles, the calibration and software used.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "app/facts/analysis_facts.h"
#include "app/report/content.h"
#include "app/report/set_points.h"
#include "app/report/tally.h"
#include "app/text/format.h"
#include "touchdown/analysis/statistics/agreement_statistics.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;

Cell CountCell(int n) { return {fmt::format("{}", n)}; }

// Program against person in the paper's two words, by [program][person] of
// slide and bounce, with the proportion that agrees and McNemar's test of
// whether one of the two sees more bounces. Nothing where no trial bears both
// labels.
std::vector<Block> MakeLabels(const Group& group) {
  if (group.labels.empty()) return {};
  int count[2][2] = {};
  int undecided = 0;
  for (const LabelPair& pair : group.labels) {
    const std::string program = PaperWord(pair.by_program);
    const std::string person = PaperWord(pair.by_person);
    if (program == "undecided" || person == "undecided") {
      ++undecided;
    } else {
      ++count[program == "bounce" ? 1 : 0][person == "bounce" ? 1 : 0];
    }
  }
  Table table{"Two labels of the same trials: program, and person",
              {{"program"}, {"person: slide", true}, {"person: bounce", true}},
              {}};
  table.rows.push_back(
      {{"slide"}, CountCell(count[0][0]), CountCell(count[0][1])});
  table.rows.push_back(
      {{"bounce"}, CountCell(count[1][0]), CountCell(count[1][1])});
  // Only the trials on which the two differ tell which of them is inclined to
  // which word.
  const analysis::McNemar test =
      analysis::McNemarTest(count[0][1], count[1][0]);
  // The interval first: with few trials it says more than a p.
  std::string agreement;
  const int right = count[0][0] + count[1][1];
  const int n = right + count[0][1] + count[1][0];
  if (n > 0) {
    const auto interval = analysis::WilsonInterval(right, n);
    agreement =
        fmt::format(" Both agree in {} of {}, 95 % {:.3f} to {:.3f} (Wilson).",
                    right, n, interval.low, interval.high);
  }
  std::string text = fmt::format(
      "{} trials bear both labels, because a person revised what the program "
      "had said; they were chosen, not drawn.{} Discordant: {} against {}; "
      "McNemar exact p = {:.3g}, mid-p = {:.3g}.",
      group.labels.size(), agreement, count[0][1], count[1][0], test.p_exact,
      test.p_mid);
  if (undecided > 0) {
    text += fmt::format(
        " {} of them, undecided by one of the two, {} not in the table.",
        undecided, undecided == 1 ? "is" : "are");
  }
  return {table, Paragraph{text, true}};
}

// The u that one source gives to a budget, in its unit: its lines, added in
// squares. 0 where the budget has no such line.
double FromSource(const core::Budget& budget, const std::string& source) {
  double square = 0.0;
  for (const auto& line : budget) {
    if (line.source == source) square += line.u * line.u;
  }
  return std::sqrt(square);
}

// A u in degrees to two digits; a plain 0 where the source gives nothing.
Cell UncertaintyCell(double u_rad) {
  return {u_rad > 0.0 ? fmt::format("{:.2g}", u_rad / kDegree) : "0"};
}

// One row a trial, one column a source with the largest first; the last row has
// the root mean squares. All in degrees. Nothing where no trial has a budget.
std::vector<Block> MakeBudget(const Group& group,
                              std::span<const core::Trial> trials,
                              const ReportInput& input) {
  // Sum over the trials that count, by source: it orders the columns and makes
  // the last row.
  std::map<std::string, double> squares;
  int n = 0;
  for (const auto& o : group.trials.observations) {
    const core::Budget& budget = AngleBudget(trials[o.trial]);
    if (budget.empty()) continue;
    ++n;
    for (const auto& line : budget) squares[line.source] += line.u * line.u;
  }
  if (n == 0) return {};
  std::vector<std::pair<double, std::string>> sources;
  sources.reserve(squares.size());
  double all = 0.0;
  for (const auto& [source, sum] : squares) {
    sources.emplace_back(std::sqrt(sum / n), source);
    all += sum / n;
  }
  // Equal sources in the order of their names, so that the same trials give the
  // same table.
  std::sort(sources.begin(), sources.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  });
  Table table{fmt::format("Budget of the {} (u in deg)", AngleName(group)),
              {{"clip or trial"}},
              {}};
  for (const auto& [u, source] : sources) {
    table.columns.push_back({source, true});
  }
  table.columns.push_back({"all", true});
  // Trials that the statistics leave out have a row too, but are not in the
  // means.
  for (const std::size_t t : group.members) {
    const core::Budget& budget = AngleBudget(trials[t]);
    if (budget.empty()) continue;
    std::vector<Cell> row{TrialCell(trials[t], input)};
    for (const auto& [rms, source] : sources) {
      row.push_back(UncertaintyCell(FromSource(budget, source)));
    }
    const core::Measured angle = core::ContactAngle(trials[t]);
    // The stated u of the angle, not the sum of the row: a person may have
    // stated it.
    row.push_back(angle ? UncertaintyCell(angle->u) : Cell{});
    table.rows.push_back(std::move(row));
  }
  std::vector<Cell> last{{"root mean square of the trials that count"}};
  for (const auto& [rms, source] : sources) {
    last.push_back(UncertaintyCell(rms));
  }
  last.push_back(UncertaintyCell(std::sqrt(all)));
  table.rows.push_back(std::move(last));
  std::vector<Block> out{std::move(table)};
  const auto total = static_cast<int>(group.trials.observations.size());
  if (n < total) {
    out.push_back(Paragraph{
        fmt::format("{} of {} trials have a budget.", n, total), true});
  }
  return out;
}

// With what the group was measured: the rig, where scale, ground line,
// calibration and time base come from, version and options of the analysis, and
// who stated the revisions. Each value with the number of trials that have it.
std::vector<Block> MakeProvenance(const Group& group,
                                  std::span<const core::Trial> trials,
                                  const ReportInput& input) {
  // Names in the order of AnalysisSources(), which is the same for every trial.
  std::vector<std::pair<std::string, Tally>> sources;
  Tally software;
  Tally options;
  Tally author;
  for (const std::size_t t : group.members) {
    const core::Trial& trial = trials[t];
    software.Add(trial.software_version);
    options.Add(trial.options_hash);
    author.Add(trial.author);
    const auto facts = AnalysisSources(trial);
    for (std::size_t i = 0; i < facts.size(); ++i) {
      if (i == sources.size()) sources.emplace_back(facts[i].first, Tally());
      sources[i].second.Add(facts[i].second);
    }
  }
  Table table{"", {{"measured with"}, {""}}, {}};
  const auto row = [&](const std::string& name, const std::string& text) {
    if (!text.empty()) table.rows.push_back({{name}, {text}});
  };
  for (const auto& [name, value] : input.rig.facts) row(name, value);
  for (const auto& [name, tally] : sources) row(name, tally.Text());
  row("analysed by version", software.Text());
  row("options of the analysis (digest)", options.Text());
  row("last stated by", author.Text());
  if (table.rows.empty()) return {};
  std::vector<Block> out{table};
  if (input.rig.facts.empty()) {
    out.push_back(Paragraph{
        "No description of the rig was given (--rig RIG.toml).", true});
  }
  return out;
}

}  // namespace

std::vector<Block> MakeEvidence(const Group& group,
                                std::span<const core::Trial> trials,
                                const ReportInput& input) {
  std::vector<Block> out;
  for (auto part : {MakeLabels(group), MakeBudget(group, trials, input),
                    MakeProvenance(group, trials, input)}) {
    for (Block& block : part) out.push_back(std::move(block));
  }
  if (!out.empty()) out.insert(out.begin(), Heading{3, "Evidence"});
  return out;
}

}  // namespace touchdown::report
