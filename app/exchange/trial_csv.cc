#include "app/exchange/trial_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <istream>
#include <optional>
#include <ostream>
#include <set>
#include <stdexcept>
#include <string_view>

#include "app/exchange/trial_csv_columns.h"
#include "app/text/csv_record.h"
#include "app/text/text.h"
#include "touchdown/core/edge_unit.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/quantities.h"

namespace touchdown::report {
namespace {

using core::Trial;

constexpr const char* kNotRecorded = "not recorded";

// What the user may have meant by a column that is not known, as the end of an
// error message: "diameter_m" where "diameter_mm" is known is the same quantity
// in another unit. Guessing the unit would put a factor of 1000 into the store.
std::string Hint(const std::string& unknown) {
  // The name without what follows its last underscore, which is the unit.
  const auto stem = [](std::string_view text) {
    const auto cut = text.rfind('_');
    return cut == std::string_view::npos ? text : text.substr(0, cut);
  };
  for (const auto& column : AllColumns()) {
    if (stem(column.about.name) == stem(unknown) ||
        column.about.name == stem(unknown) ||
        stem(column.about.name) == unknown) {
      return fmt::format("; this table has it as '{}'", column.about.name);
    }
  }
  return "; see `touchdown import --columns`";
}

// The columns of the file, in its order. Throws core::InputError naming file
// and row where the first row is not a header that this program can read: the
// file is refused as a whole, since every row would be wrong.
std::vector<const TrialColumn*> ReadHeader(std::istream& in,
                                           const std::string& name) {
  SkipByteOrderMark(in);
  const auto header = ReadCsvRecord(in, name, 1);
  if (!header) {
    throw core::InputError(
        fmt::format("{}: the file is empty; a header row was expected", name));
  }
  std::vector<const TrialColumn*> columns;
  std::set<std::string> seen;
  for (const auto& cell : *header) {
    const TrialColumn* column = FindColumn(cell);
    if (column == nullptr) {
      throw core::InputError(fmt::format("{}: row 1: there is no column '{}'{}",
                                         name, cell, Hint(cell)));
    }
    // Which of the two would count is for the user to say.
    if (!seen.insert(cell).second) {
      throw core::InputError(
          fmt::format("{}: row 1: column '{}' comes twice", name, cell));
    }
    columns.push_back(column);
  }
  // Neither has a default: a body or a state that nobody stated would be made
  // up.
  for (const char* required : {"body_kind", "state"}) {
    if (!seen.contains(required)) {
      throw core::InputError(
          fmt::format("{}: row 1: column '{}' is missing, it must be there",
                      name, required));
    }
  }
  return columns;
}

// A trial of which nothing is known but that a person logged it. A touchdown
// counts as seen, as a state was judged; each number is absent with the same
// reason until a cell gives it.
Trial EmptyTrial(const std::string& author) {
  Trial trial;
  trial.origin = core::Origin::kManual;
  trial.author = author;
  trial.first.contact.found = true;
  for (std::size_t i = 0; i < core::kContactQuantities.size(); ++i) {
    ContactMeasured(trial, i) = core::AbsentBecause(kNotRecorded);
  }
  for (std::size_t i = 0; i < core::kBodyQuantities.size(); ++i) {
    BodyMeasured(trial, i) = core::AbsentBecause(kNotRecorded);
  }
  return trial;
}

}  // namespace

// Names and meanings alone, for `touchdown import --columns`.
const std::vector<CsvColumn>& TrialCsvColumns() {
  static const std::vector<CsvColumn> columns = [] {
    std::vector<CsvColumn> about;
    for (const auto& column : AllColumns()) about.push_back(column.about);
    return about;
  }();
  return columns;
}

void WriteTrialsCsv(std::ostream& out, std::span<const Trial> trials) {
  const auto& columns = AllColumns();
  for (std::size_t i = 0; i < columns.size(); ++i) {
    out << (i == 0 ? "" : ",") << columns[i].about.name;
  }
  out << "\r\n";
  for (const Trial& trial : trials) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      out << (i == 0 ? "" : ",") << CsvCell(columns[i].write(trial));
    }
    out << "\r\n";
  }
}

// Goes on after a wrong row, so that the user sees all mistakes of a file at
// once. Whether the right rows of such a file are logged is for the caller:
// `import` does so with --partial alone.
CsvTrials ReadTrialsCsv(std::istream& in, const std::string& name,
                        const std::string& author) {
  const auto columns = ReadHeader(in, name);
  const bool has_angle_kind =
      std::ranges::any_of(columns, [](const TrialColumn* column) {
        return column->about.name == "angle_kind";
      });
  CsvTrials result;
  // The header is row 1, as a spreadsheet counts.
  std::size_t row = 1;
  while (const auto cells = ReadCsvRecord(in, name, ++row)) {
    if (cells->size() == 1 && cells->front().empty()) continue;  // blank line
    // Whether this row is right is told by the number of errors before it.
    const std::size_t errors_before = result.errors.size();
    const auto fail = [&](std::string_view column, std::string_view cell,
                          std::string_view what) {
      result.errors.push_back(fmt::format("{}: row {}, column {}: '{}': {}",
                                          name, row, column, cell, what));
    };
    // The cells cannot be told apart by column: usually a comma stands in a
    // text without quotes.
    if (cells->size() != columns.size()) {
      result.errors.push_back(
          fmt::format("{}: row {}: {} cells, {} as in the header were expected",
                      name, row, cells->size(), columns.size()));
      continue;
    }
    // The author given with the command holds unless the row has its own.
    Trial trial = EmptyTrial(author);
    bool kind_given = false;
    // Values before their uncertainties, whatever the order of the columns.
    for (const bool uncertainties : {false, true}) {
      // One mistake is told once: a bad value has no uncertainty to speak of.
      if (result.errors.size() != errors_before) break;
      for (std::size_t i = 0; i < columns.size(); ++i) {
        const auto& about = columns[i]->about;
        // A cell that this program wrote may have an apostrophe against
        // formulas.
        const std::string cell = CsvCellText((*cells)[i]);
        if (columns[i]->is_uncertainty != uncertainties) continue;
        // An empty cell leaves what EmptyTrial() set.
        if (cell.empty()) {
          if (about.name == "body_kind" || about.name == "state") {
            fail(about.name, cell, "a word was expected");
          }
          continue;
        }
        kind_given = kind_given || about.name == "angle_kind";
        // The column knows what it expects; file, row and column are added
        // here.
        try {
          columns[i]->read(trial, cell);
        } catch (const std::invalid_argument& error) {
          fail(about.name, cell, error.what());
        }
      }
    }
    // A value without a cell for u still has the -1 that the value's column
    // set. A number without an uncertainty is not taken: 0 would claim that it
    // is exact.
    const auto require_u = [&](std::string_view quantity,
                               const core::Measured& measured) {
      if (measured && measured->u < 0 &&
          result.errors.size() == errors_before) {
        // The user looks for the column as it is in the file, not for the inner
        // name.
        const core::EdgeUnit unit = core::AtTheEdge(quantity);
        fail(unit.stem + "_u" + unit.suffix, "",
             "a standard uncertainty was expected beside the value");
      }
    };
    for (const auto& quantity : core::kBodyQuantities) {
      require_u(quantity.name, trial.body.*quantity.member);
    }
    for (const auto& quantity : core::kContactQuantities) {
      require_u(quantity.name, core::At(trial.first, quantity));
    }
    if (trial.author.empty()) {
      fail("author", "", "who states this was expected (or give --by)");
    }
    // The default depends on the body's kind, which any column of the row may
    // give: so it is set last.
    if (!has_angle_kind || !kind_given) {
      trial.angle_kind = core::DefaultAngleKind(trial.body.kind);
    }
    if (result.errors.size() == errors_before) {
      result.trials.push_back({row, std::move(trial)});
    }
  }
  return result;
}

}  // namespace touchdown::report
