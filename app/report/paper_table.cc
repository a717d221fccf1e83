// Table 1 in the paper's layout: angles across, bodies down, two words; below
// each body what the paper's own table says.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>

#include "app/report/content.h"
#include "app/text/format.h"
#include "touchdown/analysis/statistics/paper_table1.h"
#include "touchdown/core/units.h"

namespace touchdown::report {
namespace {

using core::kDegree;

// So many angles fit side by side on A4; the paper has nine.
constexpr std::size_t kAnglesAcross = 9;
// More angles than this are binned.
constexpr std::size_t kMaxAngles = 36;
// Angles are told apart to a hundredth of a degree: set-points are not finer.
constexpr double kAngle_deg = 0.01;
// An angle is one of the paper's where it is this close: they are printed to a
// tenth.
constexpr double kPaperAngle_deg = 0.05;

// A column of the table: the angle in units of the column's width, rounded
// where every angle has a column of its own, and rounded down where columns are
// bins.
using AngleKey = long long;  // units of the column's width

// Where a trial stands in the table, in degrees: at its set-point, as in the
// paper, or at its measured angle where it has none. The trial must count, so
// that it has a contact angle.
double Position_deg(const core::Trial& trial) {
  if (trial.set_angle_rad) return *trial.set_angle_rad / kDegree;
  return core::ContactAngle(trial)->value / kDegree;
}

// All columns of the table, from the smallest angle, with the trials of each
// group at each of them.
struct Angles {
  double width_deg = kAngle_deg;
  bool binned = false;
  // [angle][group] -> trials
  std::map<AngleKey, std::vector<std::vector<std::size_t>>> cells;
};

// Sorts the trials that count into columns of `width_deg`. A trial stands in
// one column; `trials` decides on the order within it.
Angles Collect(std::span<const Group> groups,
               std::span<const core::Trial> trials, double width_deg,
               bool binned) {
  Angles rows{width_deg, binned, {}};
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<std::size_t> members;
    for (const auto& o : groups[g].trials.observations) {
      members.push_back(o.trial);
    }
    std::sort(members.begin(), members.end());
    for (const std::size_t t : members) {
      const double at = Position_deg(trials[t]) / width_deg;
      // The small number keeps 12.0 deg, which radians and back may make
      // 11.999..., in the bin that begins with it.
      const auto key = static_cast<AngleKey>(binned ? std::floor(at + 1e-9)
                                                    : std::round(at));
      auto& row = rows.cells[key];
      row.resize(groups.size());
      row[g].push_back(t);
    }
  }
  return rows;
}

// The columns as the user asked for them (`bin_width_rad` > 0), else a column
// for each angle, else the narrowest bins that leave no more than kMaxAngles.
Angles CollectToFit(std::span<const Group> groups,
                    std::span<const core::Trial> trials, double bin_width_rad) {
  if (bin_width_rad > 0.0) {
    return Collect(groups, trials, bin_width_rad / kDegree, true);
  }
  Angles rows = Collect(groups, trials, kAngle_deg, false);
  for (const double width_deg : {1.0, 2.0, 5.0, 10.0}) {
    if (rows.cells.size() <= kMaxAngles) break;
    rows = Collect(groups, trials, width_deg, true);
  }
  return rows;
}

// "12.400 ± 0.050" of one trial, "4 trials, 12.1 – 12.9" of several; empty
// where the group has none at this angle.
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

// "slide" of one trial, "slide 3, bounce 1" of several. The colour is that of
// the word where all trials say the same.
Cell StateCountsCell(const std::vector<std::size_t>& members,
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

// Whether the body bounces at this angle in the paper's table; nothing where
// the table does not have the angle.
std::optional<bool> PaperBounces(core::BodyKind body, double angle_deg) {
  for (const auto& o : analysis::PaperTable1(body, 0.0)) {
    if (std::abs(o.angle_rad / kDegree - angle_deg) <= kPaperAngle_deg) {
      return o.outcome == analysis::Outcome::kBounce;
    }
  }
  return std::nullopt;
}

// "12.4", or "12 – 14" of a bin.
std::string AngleHeading(const Angles& angles, double angle_deg) {
  return angles.binned ? fmt::format("{} {} {}", Plain(angle_deg), kDash,
                                     Plain(angle_deg + angles.width_deg))
                       : Plain(angle_deg);
}

// Whether the paper has one of the angles at which the group was thrown: else
// its row would be empty. Bins hold several angles and are not compared.
bool HasPaperAngle(const Angles& angles, std::size_t group,
                   core::BodyKind body) {
  return !angles.binned &&
         std::any_of(
             angles.cells.begin(), angles.cells.end(), [&](const auto& column) {
               const auto& [key, cells] = column;
               return !cells[group].empty() &&
                      PaperBounces(body,
                                   static_cast<double>(key) * angles.width_deg);
             });
}

}  // namespace

std::vector<Table> MakeTable1(std::span<const Group> groups,
                              std::span<const core::Trial> trials,
                              const ReportInput& input) {
  const Angles angles = CollectToFit(groups, trials, input.bin_width_rad);
  // The heading says what the angles are: set-points as soon as one trial has
  // one.
  const bool any_set =
      std::any_of(groups.begin(), groups.end(), [&](const Group& group) {
        return std::any_of(group.trials.observations.begin(),
                           group.trials.observations.end(),
                           [&](const analysis::Observation& o) {
                             return trials[o.trial].set_angle_rad.has_value();
                           });
      });
  const char* angle_word = any_set ? "set" : "contact";
  // More columns than fit side by side become several tables.
  const std::size_t parts =
      (angles.cells.size() + kAnglesAcross - 1) / kAnglesAcross;
  std::vector<Table> out;
  auto column = angles.cells.begin();
  for (std::size_t part = 0; part < parts; ++part) {
    Table table;
    table.row_headings = true;
    table.caption = "Table 1: motion state by contact angle";
    if (parts > 1) {
      table.caption += fmt::format(" ({} of {})", part + 1, parts);
    }
    table.columns.push_back(
        {angles.binned ? fmt::format("{} angle, bins of {} deg", angle_word,
                                     Plain(angles.width_deg))
                       : fmt::format("{} angle (deg)", angle_word)});
    // As many in each part, as far as they go.
    const std::size_t left = angles.cells.size() * (part + 1) / parts -
                             angles.cells.size() * part / parts;
    const auto begin = column;
    std::advance(column, left);
    for (auto at = begin; at != column; ++at) {
      table.columns.push_back(
          {AngleHeading(angles,
                        static_cast<double>(at->first) * angles.width_deg),
           true});
    }
    // Each body has two rows, or three with the paper's own.
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const core::BodyKind body = groups[g].trials.body;
      const std::string name = ShortName(groups[g], groups);
      std::vector<Cell> measured{{fmt::format(
          "{}: {} {} u (deg)", name, AngleName(groups[g]), kPlusMinus)}};
      std::vector<Cell> states{{name + ": motion state"}};
      std::vector<Cell> papers{{name + ": the paper's own"}};
      for (auto at = begin; at != column; ++at) {
        measured.push_back(AngleCell(at->second[g], trials));
        states.push_back(StateCountsCell(at->second[g], trials));
        const auto paper = PaperBounces(
            body, static_cast<double>(at->first) * angles.width_deg);
        papers.push_back(
            {paper ? (*paper ? "bounce" : "slide") : "", Tone::kMuted});
      }
      table.rows.push_back(std::move(measured));
      table.rows.push_back(std::move(states));
      if (HasPaperAngle(angles, g, body)) {
        table.rows.push_back(std::move(papers));
      }
    }
    out.push_back(std::move(table));
  }
  return out;
}

}  // namespace touchdown::report
