#include "app/trials/trials_csv.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <string_view>

#include "app/text/csv_record.h"
#include "app/text/parse_number.h"
#include "touchdown/analysis/statistics/observation.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

using core::kDegree;

// Takes blanks, a carriage return and quotation marks from the ends of `text`.
// Spreadsheets quote headings and write Windows line ends.
std::string Trimmed(std::string_view text) {
  const auto is_blank = [](char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '"';
  };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return std::string(text);
}

// Says where a message points to; lines count from 1, headings and comments
// included.
struct Place {
  const std::filesystem::path& path;
  int line = 0;
};

// "angles.csv: line 7: p_bounce is '2'; expected ...".
[[noreturn]] void RefuseLine(const Place& place, const std::string& what) {
  throw core::InputError(
      fmt::format("{}: line {}: {}", place.path.string(), place.line, what));
}

// Reads the number in a cell, in the column's own unit, low <= value <= high;
// `range` says that in words. An empty cell is refused, too.
double ReadCell(const Place& place, std::string_view column,
                const std::string& cell, double low, double high,
                std::string_view range) {
  const auto value = report::ParseNumber<double>(cell);
  if (!value || !(*value >= low && *value <= high)) {
    RefuseLine(place, fmt::format("{} is '{}'; expected a number {}", column,
                                  cell, range));
  }
  return *value;
}

// `u_deg` is the trial's own, `common_u_deg` what its set-up shares.
core::Trial MakeTrial(const CsvTrials& what, double angle_deg, double u_deg,
                      double common_u_deg, double p_bounce) {
  core::Trial trial;
  trial.campaign = what.campaign;
  trial.body = core::UnmeasuredBody(what.body);
  trial.angle_kind = what.angle_kind;
  trial.origin = what.origin;
  core::Contact& contact = trial.first.contact;
  contact.found = true;
  core::Angle(contact, what.angle_kind) = core::Estimate{
      angle_deg * kDegree, std::hypot(u_deg, common_u_deg) * kDegree};
  if (common_u_deg > 0.0) {
    // The budget keeps the two parts apart: statistics treat the common one as
    // one error of the whole set-up, not as one a trial.
    core::Budget& budget = what.angle_kind == core::AngleKind::kApproach
                               ? contact.approach_budget
                               : contact.attitude_budget;
    budget = {{"own", u_deg * kDegree}, {"common", common_u_deg * kDegree}};
  }
  core::StateDecision& state = trial.first.state;
  state.p_bounce = p_bounce;
  state.max_gap_m = core::AbsentBecause("not in the file");
  state.extrapolated_gap_m = core::AbsentBecause("not in the file");
  // The label follows from the probability by the rule of the statistics, so
  // that a CSV file and a store agree. The angle plays no part in it.
  switch (analysis::Observe(0.0, 0.0, p_bounce).outcome) {
    case analysis::Outcome::kBounce:
      state.label = core::MotionState::kBounce;
      break;
    case analysis::Outcome::kNotBounce:
      state.label = core::MotionState::kStaysDown;
      break;
    case analysis::Outcome::kUndecided:
      state.label = core::MotionState::kUndecided;
      break;
  }
  return trial;
}

}  // namespace

std::vector<core::Trial> ReadTrialsCsv(const std::filesystem::path& path,
                                       const CsvTrials& what) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) {
    throw core::InputError(fmt::format(
        "{}: cannot be read; expected a CSV file with the columns angle_deg, "
        "u_deg and p_bounce",
        path.string()));
  }
  std::vector<std::string> header;
  std::vector<core::Trial> trials;
  Place place{path, 0};
  int lines = 0;  // read so far; a quoted cell may hold several
  // Returns the position of a column in the heading, nothing where it is not
  // there.
  const auto find = [&](std::string_view name) -> std::optional<std::size_t> {
    const auto at = std::find(header.begin(), header.end(), name);
    if (at == header.end()) return std::nullopt;
    return static_cast<std::size_t>(at - header.begin());
  };
  report::SkipByteOrderMark(file);
  while (true) {
    place.line = ++lines;
    if (file.peek() == '#') {
      file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
      continue;
    }
    auto record = report::ReadCsvRecord(file, path.string(),
                                        static_cast<std::size_t>(lines));
    if (!record) break;
    std::vector<std::string>& cells = *record;
    for (std::string& cell : cells) {
      lines += static_cast<int>(std::ranges::count(cell, '\n'));
      cell = Trimmed(cell);
    }
    if (cells.size() == 1 && cells.front().empty()) continue;
    // The first line that is neither blank nor a comment is the heading.
    if (header.empty()) {
      header = cells;
      for (const char* column : {"angle_deg", "u_deg", "p_bounce"}) {
        if (!find(column)) {
          RefuseLine(place,
                     fmt::format("there is no column {}; expected the "
                                 "columns angle_deg, u_deg, p_bounce and, "
                                 "where there were set-points, "
                                 "set_angle_deg",
                                 column));
        }
      }
      continue;
    }
    if (cells.size() != header.size()) {
      RefuseLine(place, fmt::format("{} cells; expected {}, as in the heading",
                                    cells.size(), header.size()));
    }
    // Reads a cell of this line, from 0 to `high`; the column must exist.
    const auto number = [&](std::string_view column, double high,
                            std::string_view range) {
      return ReadCell(place, column, cells[*find(column)], 0.0, high, range);
    };
    const auto common = find("common_u_deg");
    trials.push_back(
        MakeTrial(what, number("angle_deg", 90.0, "from 0 to 90"),
                  number("u_deg", 90.0, "from 0 to 90"),
                  common && !cells[*common].empty()
                      ? number("common_u_deg", 90.0, "from 0 to 90, or nothing")
                      : 0.0,
                  number("p_bounce", 1.0, "from 0 to 1")));
    // Trials of one calibration share their common error; the name alone tells
    // the set-ups apart, it is in no register.
    if (const auto setup = find("calibration");
        setup && !cells[*setup].empty()) {
      trials.back().conditions.emplace().calibration.name = cells[*setup];
    }
    trials.back().id = fmt::format("line {}", place.line);
    const auto set = find("set_angle_deg");
    if (set && !cells[*set].empty()) {
      trials.back().set_angle_rad =
          number("set_angle_deg", 90.0, "from 0 to 90, or nothing") * kDegree;
    }
  }
  if (header.empty()) {
    throw core::InputError(fmt::format(
        "{}: is empty; expected a heading with the columns angle_deg, u_deg "
        "and p_bounce",
        path.string()));
  }
  return trials;
}

}  // namespace touchdown::pipeline
