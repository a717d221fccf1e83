// What stands behind a group's trials: the two labels of those that a person
// revised, the budget of their angles, the calibration and software used.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "app/report/content.h"
#include "app/report/format.h"
#include "touchdown/analysis/agreement_statistics.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;
using Json = nlohmann::json;

Cell Number(int n) { return {fmt::format("{}", n)}; }

// Program against person, by [program][person] of slide and bounce.
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
  table.rows.push_back({{"slide"}, Number(count[0][0]), Number(count[0][1])});
  table.rows.push_back({{"bounce"}, Number(count[1][0]), Number(count[1][1])});
  const analysis::McNemar test =
      analysis::McNemarTest(count[0][1], count[1][0]);
  std::string text = fmt::format(
      "{} trials bear both labels, because a person revised what the program "
      "had said; they were chosen, not drawn. Discordant: {} against {}; "
      "McNemar exact p = {:.3g}, mid-p = {:.3g}.",
      group.labels.size(), count[0][1], count[1][0], test.p_exact, test.p_mid);
  if (undecided > 0) {
    text += fmt::format(
        " {} of them, undecided by one of the two, {} not in the table.",
        undecided, undecided == 1 ? "is" : "are");
  }
  return {table, Paragraph{text, true}};
}

// Root mean square over the trials of each source, largest first.
std::vector<Block> MakeBudget(const Group& group,
                              std::span<const core::Trial> trials) {
  std::map<std::string, double> squares;
  int n = 0;
  for (const auto& o : group.trials.observations) {
    const core::Contact& contact = trials[o.trial].first.contact;
    const core::Budget& budget =
        group.trials.angle_kind == core::AngleKind::kApproach
            ? contact.approach_budget
            : contact.attitude_budget;
    if (budget.empty()) continue;
    ++n;
    for (const auto& line : budget) squares[line.source] += line.u * line.u;
  }
  if (n == 0) return {};
  std::vector<std::pair<double, std::string>> lines;
  lines.reserve(squares.size());
  for (const auto& [source, sum] : squares) {
    lines.emplace_back(std::sqrt(sum / n), source);
  }
  std::sort(lines.begin(), lines.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  });
  Table table{fmt::format("Budget of the {}", AngleName(group)),
              {{"source"}, {"u, root mean square over the trials (deg)", true}},
              {}};
  for (const auto& [u, source] : lines) {
    table.rows.push_back({{source}, {fmt::format("{:.3g}", u / kDegree)}});
  }
  std::vector<Block> out{table};
  const auto total = static_cast<int>(group.trials.observations.size());
  if (n < total) {
    out.push_back(Paragraph{
        fmt::format("{} of {} trials have a budget.", n, total), true});
  }
  return out;
}

// The distinct values of one thing, and how many trials have each.
class Tally {
 public:
  void Add(const std::string& value) {
    if (!value.empty()) ++count_[value];
  }
  std::string Text() const {
    // Beyond these the row would say less than "many".
    constexpr std::size_t kMost = 6;
    if (count_.size() > kMost) {
      return fmt::format("{} different ones", count_.size());
    }
    std::string out;
    for (const auto& [value, n] : count_) {
      out += fmt::format("{}{} ({} trial{})", out.empty() ? "" : "; ", value, n,
                         n == 1 ? "" : "s");
    }
    return out;
  }

 private:
  std::map<std::string, int> count_;
};

std::string TextAt(const Json& json, const char* object, const char* field) {
  const auto outer = json.find(object);
  if (outer == json.end() || !outer->is_object()) return "";
  const auto inner = outer->find(field);
  return inner != outer->end() && inner->is_string() ? inner->get<std::string>()
                                                     : "";
}

std::string FramesPerSecond(const Json& json) {
  const auto clip = json.find("clip");
  if (clip == json.end() || !clip->is_object()) return "";
  const auto base = clip->find("time_base");
  if (base == clip->end() || !base->is_object()) return "";
  const auto fps = base->find("fps");
  if (fps == base->end() || !fps->is_number()) return "";
  return fmt::format("{:g} frames/s, from the {}", fps->get<double>(),
                     base->value("source", "file"));
}

std::vector<Block> MakeProvenance(const Group& group,
                                  std::span<const core::Trial> trials) {
  Tally scale;
  Tally ground;
  Tally frames;
  Tally software;
  Tally options;
  Tally author;
  for (const std::size_t t : group.members) {
    const core::Trial& trial = trials[t];
    software.Add(trial.software_version);
    options.Add(trial.options_hash);
    author.Add(trial.author);
    if (trial.document_json.empty()) continue;
    const Json json = Json::parse(trial.document_json, nullptr, false);
    if (!json.is_object()) continue;
    scale.Add(TextAt(json, "scale", "source"));
    ground.Add(TextAt(json, "ground", "source"));
    frames.Add(FramesPerSecond(json));
  }
  Table table{"", {{"measured with"}, {""}}, {}};
  const auto row = [&](const char* name, const Tally& tally) {
    const std::string text = tally.Text();
    if (!text.empty()) table.rows.push_back({{name}, {text}});
  };
  row("scale from", scale);
  row("ground line from", ground);
  row("time base", frames);
  row("analysed by version", software);
  row("options of the analysis (digest)", options);
  row("last stated by", author);
  if (table.rows.empty()) return {};
  return {table};
}

}  // namespace

std::vector<Block> MakeEvidence(const Group& group,
                                std::span<const core::Trial> trials) {
  std::vector<Block> out;
  for (auto part : {MakeLabels(group), MakeBudget(group, trials),
                    MakeProvenance(group, trials)}) {
    for (Block& block : part) out.push_back(std::move(block));
  }
  if (!out.empty()) out.insert(out.begin(), Heading{3, "What stands behind"});
  return out;
}

}  // namespace touchdown::report
