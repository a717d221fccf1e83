// Lines that are blank are skipped and still counted, so that messages name the
// line that an editor shows.
#include "app/cli/case_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "app/text/csv_record.h"
#include "app/text/text.h"
#include "app/text/text_file.h"
#include "touchdown/core/errors.h"

namespace touchdown::cli {
namespace {

using core::InputError;

// Returns `text` without blanks, tabs and CR at either end. Spreadsheets and
// people add them; they never mean anything in a case file.
std::string_view Trim(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

// Holds one row as cells of text; `line` is the line of the file it begins in.
struct RawRow {
  std::size_t line = 1;
  std::vector<std::string> cells;
};

// Rows of a file that are not blank. Throws core::InputError.
std::vector<RawRow> ReadRows(const std::string& path) {
  std::istringstream in(report::ReadTextFile(path));
  report::SkipByteOrderMark(in);
  std::vector<RawRow> rows;
  std::size_t line = 1;
  while (auto cells = report::ReadCsvRecord(in, path, line)) {
    std::size_t lines = 1;
    for (const std::string& cell : *cells) {
      // A quoted line feed belongs to the cell, and is a line of the file too.
      lines +=
          static_cast<std::size_t>(std::count(cell.begin(), cell.end(), '\n'));
    }
    if (cells->size() > 1 || !Trim(cells->front()).empty()) {
      rows.push_back({line, std::move(*cells)});
    }
    line += lines;
  }
  return rows;
}

}  // namespace

CaseRow::CaseRow(std::shared_ptr<const Header> header, std::size_t line,
                 std::vector<std::string> cells)
    : header_(std::move(header)), line_(line), cells_(std::move(cells)) {}

// Returns the place of the column in the row; nothing where the header lacks
// it.
std::optional<std::size_t> CaseRow::Find(std::string_view column) const {
  const auto& columns = header_->columns;
  const auto it = std::find(columns.begin(), columns.end(), column);
  if (it == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(it - columns.begin());
}

// Returns the place of the cell that a number is taken from. A hexadecimal cell
// wins, in a column named after the quantity with its unit ("alpha_rad_hex") or
// without ("alpha_hex"); an empty cell counts as absent.
std::optional<std::size_t> CaseRow::FindNumber(std::string_view column) const {
  const auto filled = [&](const std::string& name) {
    const auto index = Find(name);
    return index && !Trim(cells_[*index]).empty() ? index : std::nullopt;
  };
  if (const auto hex = filled(std::string(column) + "_hex")) return hex;
  const std::string_view stem = column.substr(0, column.rfind('_'));
  if (const auto hex = filled(std::string(stem) + "_hex")) return hex;
  return filled(std::string(column));
}

bool CaseRow::HasColumn(std::string_view column) const {
  return Find(column).has_value();
}

const std::string& CaseRow::Text(std::string_view column) const {
  const auto index = Find(column);
  if (!index) {
    throw InputError(fmt::format("{}: header: there is no column '{}'",
                                 header_->file, column));
  }
  return cells_[*index];
}

double CaseRow::Parse(std::size_t index) const {
  // strtod reads hexadecimal floats, too; it must use up the whole cell.
  const std::string text(Trim(cells_[index]));
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (end != text.c_str() + text.size() || !std::isfinite(value)) {
    Refuse(header_->columns[index],
           "a finite number of double's range, decimal or hexadecimal");
  }
  return value;
}

double CaseRow::Number(std::string_view column) const {
  if (const auto index = FindNumber(column)) return Parse(*index);
  static_cast<void>(Text(column));  // complains where the column is missing
  Refuse(column, "a number");
}

std::optional<double> CaseRow::OptionalNumber(std::string_view column) const {
  if (const auto index = FindNumber(column)) return Parse(*index);
  return std::nullopt;
}

int CaseRow::Choice(std::string_view column,
                    const std::vector<int>& allowed) const {
  const double value = Number(column);
  std::string list;
  for (const int choice : allowed) {
    if (value == choice) return choice;
    list += fmt::format("{}{}", list.empty() ? "" : ", ", choice);
  }
  Refuse(column, "one of " + list);
}

// The cell as it stands is quoted; it is empty where the column is missing.
void CaseRow::Refuse(std::string_view column, std::string_view expected) const {
  const auto index = Find(column);
  throw InputError(fmt::format(
      "{}: line {}, column {}: is '{}', expected {}", header_->file, line_,
      column, index ? std::string(Trim(cells_[*index])) : "", expected));
}

void CaseRow::Answer(const std::function<void()>& answer) const {
  try {
    answer();
  } catch (const std::invalid_argument& error) {
    throw InputError(
        fmt::format("{}: line {}: {}", header_->file, line_, error.what()));
  }
}

bool CaseTable::HasColumn(std::string_view column) const {
  return std::find(header->columns.begin(), header->columns.end(), column) !=
         header->columns.end();
}

// All checks of form happen here, before the first case is answered: a file
// with a wrong last row gives an error and not half an answer.
CaseTable ReadCases(const std::string& path,
                    const std::vector<std::string>& columns) {
  auto raw = ReadRows(path);
  if (raw.empty()) {
    throw InputError(
        fmt::format("{}: is empty; expected a header and rows of cases", path));
  }
  // The rows share the header, which their messages need.
  auto header = std::make_shared<CaseRow::Header>();
  header->file = path;
  for (const std::string& name : raw[0].cells) {
    header->columns.emplace_back(Trim(name));
  }
  CaseTable table;
  table.header = header;
  for (const std::string& column : columns) {
    if (!table.HasColumn(column)) {
      throw InputError(
          fmt::format("{}: header: there is no column '{}'; expected {}", path,
                      column, fmt::join(columns, ", ")));
    }
  }
  for (std::size_t i = 1; i < raw.size(); ++i) {
    if (raw[i].cells.size() != header->columns.size()) {
      throw InputError(fmt::format(
          "{}: line {}: has {} cells; expected {} as in the header", path,
          raw[i].line, raw[i].cells.size(), header->columns.size()));
    }
    table.rows.emplace_back(header, raw[i].line, std::move(raw[i].cells));
  }
  if (table.rows.empty()) {
    throw InputError(fmt::format(
        "{}: has a header and no cases; expected at least one row", path));
  }
  return table;
}

// 17 significant digits give back the same double.
std::string Cell(double value) {
  return std::isnan(value) ? std::string() : fmt::format("{:.17g}", value);
}

std::string Cell(std::optional<double> value) {
  return value ? Cell(*value) : std::string();
}

std::string Cell(int value) { return std::to_string(value); }

std::string Cell(std::string_view value) { return std::string(value); }

CaseWriter::CaseWriter(const std::vector<std::string>& columns)
    : n_columns_(columns.size()) {
  Add(columns);
}

// A wrong number of cells is a bug of the caller, never of the file.
void CaseWriter::Add(const std::vector<std::string>& cells) {
  if (cells.size() != n_columns_) {
    throw std::logic_error(fmt::format("row has {} cells, table has {} columns",
                                       cells.size(), n_columns_));
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) csv_ += ',';
    csv_ += report::CsvCell(cells[i]);
  }
  csv_ += '\n';
}

// A short write to stdout is found here, while main's own check covers what was
// printed by others.
void WriteResult(std::string_view text, const std::string& path) {
  if (path.empty()) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() ||
        std::fflush(stdout) != 0) {
      throw core::OutputError(
          fmt::format("stdout: cannot be written: {}", std::strerror(errno)));
    }
    return;
  }
  report::WriteTextFile(path, text);
}

}  // namespace touchdown::cli
