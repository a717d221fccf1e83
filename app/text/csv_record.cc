#include "app/text/csv_record.h"

#include <fmt/format.h>

#include <cstddef>
#include <cstdio>
#include <istream>
#include <iterator>
#include <string_view>

#include "touchdown/core/errors.h"

namespace touchdown::report {

// The mark is the three bytes EF BB BF. What begins otherwise is part of the
// first column's name, and is put back.
void SkipByteOrderMark(std::istream& in) {
  constexpr int kMark[] = {0xef, 0xbb, 0xbf};
  std::size_t seen = 0;
  while (seen < std::size(kMark) && in.peek() == kMark[seen]) {
    in.get();
    ++seen;
  }
  for (; seen > 0 && seen < std::size(kMark); --seen) in.unget();
}

// Reads one character at a time, in one of two states: inside quotes, where
// commas and line breaks belong to the cell, or outside of them. An empty line
// is a record of one empty cell; the last line needs no line break.
std::optional<std::vector<std::string>> ReadCsvRecord(std::istream& in,
                                                      const std::string& name,
                                                      std::size_t row) {
  std::vector<std::string> cells(1);
  // Tells an empty line, which is a record, from the end of the file, which is
  // none.
  bool any = false;
  bool quoted = false;
  for (int c = in.get(); c != EOF; c = in.get()) {
    any = true;
    if (quoted) {
      if (c != '"') {
        cells.back() += static_cast<char>(c);
      } else if (in.peek() == '"') {
        // Two quotes inside a quoted cell stand for one.
        cells.back() += static_cast<char>(in.get());
      } else {
        quoted = false;
      }
      continue;
    }
    // A quote opens a quoted cell only where the cell begins; in the middle of
    // a cell (a size in inches) it is a character like any other.
    if (c == '"' && cells.back().empty()) {
      quoted = true;
    } else if (c == ',') {
      cells.emplace_back();
    } else if (c == '\n') {
      break;
    } else if (c != '\r' || in.peek() != '\n') {
      cells.back() += static_cast<char>(c);
    }
  }
  // The file ended inside quotes: everything behind the open quote would be one
  // cell, and all rows in it would be lost without a word.
  if (quoted) {
    throw core::InputError(fmt::format(
        "{}: row {}: a quote is left open; a closing \" was expected", name,
        row));
  }
  if (!any) return std::nullopt;
  return cells;
}

std::string CsvCellText(std::string cell) {
  // The characters that CsvCell() in text.cc guards against.
  constexpr std::string_view kFormulaStart = "=+-@\t\r";
  // An apostrophe before anything else was typed by a person and is kept.
  if (cell.size() > 1 && cell[0] == '\'' &&
      kFormulaStart.find(cell[1]) != std::string_view::npos) {
    cell.erase(0, 1);
  }
  return cell;
}

}  // namespace touchdown::report
