// Table 1 in the paper's layout: angles down, bodies across, two words.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "app/report/content.h"
#include "app/report/format.h"
#include "touchdown/analysis/paper_table1.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;

// So many groups fit side by side on A4.
constexpr std::size_t kGroupsAcross = 3;
// More rows than this are binned.
constexpr std::size_t kMaxRows = 40;
// Rows are told apart to a hundredth of a degree: set-points are not finer.
constexpr double kRow_deg = 0.01;
// A row is one of the paper's angles where it is this close: they are printed
// to a tenth.
constexpr double kPaperAngle_deg = 0.05;

using RowKey = long long;  // units of the row's width

double Position_deg(const core::Trial& trial) {
  if (trial.set_angle_rad) return *trial.set_angle_rad / kDegree;
  return std::abs(core::ContactAngle(trial)->value) / kDegree;
}

struct Rows {
  double width_deg = kRow_deg;
  bool binned = false;
  // [row][group] -> trials
  std::map<RowKey, std::vector<std::vector<std::size_t>>> cells;
};

Rows Collect(std::span<const Group> groups, std::span<const core::Trial> trials,
             double width_deg, bool binned) {
  Rows rows{width_deg, binned, {}};
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<std::size_t> members;
    for (const auto& o : groups[g].trials.observations) {
      members.push_back(o.trial);
    }
    std::sort(members.begin(), members.end());
    for (const std::size_t t : members) {
      const double at = Position_deg(trials[t]) / width_deg;
      const auto key =
          static_cast<RowKey>(binned ? std::floor(at + 1e-9) : std::round(at));
      auto& row = rows.cells[key];
      row.resize(groups.size());
      row[g].push_back(t);
    }
  }
  return rows;
}

Rows CollectToFit(std::span<const Group> groups,
                  std::span<const core::Trial> trials, double bin_width_rad) {
  if (bin_width_rad > 0.0) {
    return Collect(groups, trials, bin_width_rad / kDegree, true);
  }
  Rows rows = Collect(groups, trials, kRow_deg, false);
  for (const double width_deg : {1.0, 2.0, 5.0, 10.0}) {
    if (rows.cells.size() <= kMaxRows) break;
    rows = Collect(groups, trials, width_deg, true);
  }
  return rows;
}

Cell AngleCell(const std::vector<std::size_t>& members,
               std::span<const core::Trial> trials) {
  if (members.empty()) return {};
  if (members.size() == 1) {
    return {WithU(*core::ContactAngle(trials[members[0]]), kDegree)};
  }
  double low = 1e300;
  double high = -1e300;
  for (const std::size_t t : members) {
    const double angle = core::ContactAngle(trials[t])->value / kDegree;
    low = std::min(low, angle);
    high = std::max(high, angle);
  }
  return {fmt::format("{} trials, {} {} {}", members.size(), Plain(low), kDash,
                      Plain(high))};
}

Cell StateCell(const std::vector<std::size_t>& members,
               std::span<const core::Trial> trials) {
  int n[3] = {0, 0, 0};
  for (const std::size_t t : members) {
    const std::string word = PaperWord(trials[t].first.state.label);
    ++n[word == "slide" ? 0 : word == "bounce" ? 1 : 2];
  }
  static constexpr const char* kWord[] = {"slide", "bounce", "undecided"};
  static constexpr Tone kTone[] = {Tone::kSlide, Tone::kBounce,
                                   Tone::kUndecided};
  Cell cell;
  for (int i = 0; i < 3; ++i) {
    if (n[i] == 0) continue;
    cell.tone = cell.text.empty() ? kTone[i] : Tone::kPlain;
    if (!cell.text.empty()) cell.text += ", ";
    cell.text += kWord[i];
    if (members.size() > 1) cell.text += fmt::format(" {}", n[i]);
  }
  return cell;
}

// What the paper's table says at this angle, if it has it.
std::optional<bool> PaperBounces(core::BodyKind body, double angle_deg) {
  for (const auto& o : analysis::PaperTable1(body, 0.0)) {
    if (std::abs(o.angle_rad / kDegree - angle_deg) <= kPaperAngle_deg) {
      return o.outcome == analysis::Outcome::kBounce;
    }
  }
  return std::nullopt;
}

Table MakeOne(std::span<const Group> groups, std::span<const Group> all,
              std::span<const core::Trial> trials, double bin_width_rad) {
  const Rows rows = CollectToFit(groups, trials, bin_width_rad);
  bool any_set = false;
  std::vector<bool> with_paper(groups.size(), false);
  for (const auto& [key, row] : rows.cells) {
    for (std::size_t g = 0; g < groups.size(); ++g) {
      for (const std::size_t t : row[g]) {
        any_set = any_set || trials[t].set_angle_rad.has_value();
      }
      const double angle_deg = static_cast<double>(key) * rows.width_deg;
      if (!rows.binned && !row[g].empty() &&
          PaperBounces(groups[g].trials.body, angle_deg)) {
        with_paper[g] = true;
      }
    }
  }
  Table table;
  table.caption = "Table 1: motion state by contact angle";
  table.columns.push_back(
      {rows.binned
           ? fmt::format("{} angle, bins of {} deg",
                         any_set ? "set" : "contact", Plain(rows.width_deg))
       : any_set ? "set angle (deg)"
                 : "contact angle (deg)",
       true});
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const std::string name = ShortName(groups[g], all);
    table.columns.push_back({fmt::format("{}: {} {} u (deg)", name,
                                         AngleName(groups[g]), kPlusMinus),
                             true});
    table.columns.push_back({name + ": state"});
    if (with_paper[g]) table.columns.push_back({"paper's Table 1"});
  }
  for (const auto& [key, row] : rows.cells) {
    const double angle_deg = static_cast<double>(key) * rows.width_deg;
    std::vector<Cell> cells;
    cells.push_back({rows.binned
                         ? fmt::format("{} {} {}", Plain(angle_deg), kDash,
                                       Plain(angle_deg + rows.width_deg))
                         : Plain(angle_deg)});
    for (std::size_t g = 0; g < groups.size(); ++g) {
      cells.push_back(AngleCell(row[g], trials));
      cells.push_back(StateCell(row[g], trials));
      if (!with_paper[g]) continue;
      const auto paper = PaperBounces(groups[g].trials.body, angle_deg);
      cells.push_back(
          {paper ? (*paper ? "bounce" : "slide") : "", Tone::kMuted});
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

}  // namespace

std::vector<Table> MakeTable1(std::span<const Group> groups,
                              std::span<const core::Trial> trials,
                              const ReportInput& input) {
  std::vector<Table> out;
  for (std::size_t i = 0; i < groups.size(); i += kGroupsAcross) {
    const std::size_t n = std::min(kGroupsAcross, groups.size() - i);
    out.push_back(
        MakeOne(groups.subspan(i, n), groups, trials, input.bin_width_rad));
  }
  return out;
}

}  // namespace touchdown::report
