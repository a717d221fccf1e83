#include "app/text/csv_record.h"

#include <fmt/format.h>

#include <cstdio>
#include <istream>
#include <string_view>

#include "touchdown/core/errors.h"

namespace touchdown::report {

void SkipByteOrderMark(std::istream& in) {
  if (in.peek() == 0xef) in.ignore(3);
}

std::optional<std::vector<std::string>> ReadCsvRecord(std::istream& in,
                                                      const std::string& name,
                                                      std::size_t row) {
  std::vector<std::string> cells(1);
  bool any = false;
  bool quoted = false;
  for (int c = in.get(); c != EOF; c = in.get()) {
    any = true;
    if (quoted) {
      if (c != '"') {
        cells.back() += static_cast<char>(c);
      } else if (in.peek() == '"') {
        cells.back() += static_cast<char>(in.get());
      } else {
        quoted = false;
      }
      continue;
    }
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
  if (quoted) {
    throw core::InputError(fmt::format(
        "{}: row {}: a quote is left open; a closing \" was expected", name,
        row));
  }
  if (!any) return std::nullopt;
  return cells;
}

std::string CsvCellText(std::string cell) {
  constexpr std::string_view kFormulaStart = "=+-@\t\r";
  if (cell.size() > 1 && cell[0] == '\'' &&
      kFormulaStart.find(cell[1]) != std::string_view::npos) {
    cell.erase(0, 1);
  }
  return cell;
}

}  // namespace touchdown::report
