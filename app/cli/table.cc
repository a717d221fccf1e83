#include "app/cli/table.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "touchdown/core/errors.h"

namespace touchdown::cli {
namespace {

std::string ReadAll(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  if (!in || !(text << in.rdbuf())) {
    throw core::InputError(path + ": cannot be read, expected a CSV file");
  }
  return text.str();
}

std::vector<Row> Split(const std::string& text, const std::string& path) {
  std::vector<Row> rows;
  Row row{1, {}};
  std::string cell;
  std::size_t line = 1;
  bool quoted = false;
  bool was_quoted = false;
  const auto end_row = [&] {
    row.cells.push_back(std::move(cell));
    cell.clear();
    const bool blank =
        row.cells.size() == 1 && row.cells[0].empty() && !was_quoted;
    if (!blank) rows.push_back(std::move(row));
    row = Row{line, {}};
    was_quoted = false;
  };
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  std::size_t i = text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
  for (; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\n') ++line;
    if (quoted) {
      if (c != '"') {
        cell += c;
      } else if (i + 1 < text.size() && text[i + 1] == '"') {
        cell += c;
        ++i;
      } else {
        quoted = false;
      }
    } else if (c == '"' && cell.empty()) {
      quoted = true;
      was_quoted = true;
    } else if (c == ',') {
      row.cells.push_back(std::move(cell));
      cell.clear();
    } else if (c == '\n') {
      end_row();
    } else if (c != '\r') {
      cell += c;
    }
  }
  if (quoted) {
    throw core::InputError(
        fmt::format("{}:{}: a quote is not closed", path, row.line));
  }
  if (!cell.empty() || !row.cells.empty()) end_row();
  return rows;
}

}  // namespace

Table::Table(const std::filesystem::path& path) : path_(path.string()) {
  rows_ = Split(ReadAll(path_), path_);
  if (rows_.empty()) {
    throw core::InputError(path_ + ": is empty, expected a header row");
  }
  header_ = std::move(rows_.front().cells);
  rows_.erase(rows_.begin());
  for (const Row& row : rows_) {
    if (row.cells.size() == header_.size()) continue;
    throw core::InputError(fmt::format("{}:{}: {} cells, the header has {}",
                                       path_, row.line, row.cells.size(),
                                       header_.size()));
  }
}

std::optional<std::size_t> Table::Find(std::string_view column) const {
  const auto at = std::find(header_.begin(), header_.end(), column);
  if (at == header_.end()) return std::nullopt;
  return static_cast<std::size_t>(at - header_.begin());
}

bool Table::Has(std::string_view column) const {
  return Find(column).has_value();
}

const std::string& Table::Text(const Row& row, std::string_view column) const {
  const auto index = Find(column);
  if (!index) {
    throw core::InputError(
        fmt::format("{}:1: column {} is missing", path_, column));
  }
  return row.cells[*index];
}

double Table::Number(const Row& row, std::string_view column) const {
  std::string name(column);
  const std::string hex = name + "_hex";
  if (Has(hex) && !Text(row, hex).empty()) name = hex;
  const std::string& text = Text(row, name);
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const bool whole = !text.empty() && end == text.c_str() + text.size();
  if (!whole || !std::isfinite(value)) {
    throw core::InputError(
        fmt::format("{}:{}: {} is \"{}\", expected a finite number", path_,
                    row.line, name, text));
  }
  return value;
}

std::optional<double> Table::OptionalNumber(const Row& row,
                                            std::string_view column) const {
  const std::string hex = std::string(column) + "_hex";
  const bool given = (Has(column) && !Text(row, column).empty()) ||
                     (Has(hex) && !Text(row, hex).empty());
  if (!given) return std::nullopt;
  return Number(row, column);
}

}  // namespace touchdown::cli
