// Reads the small reference tables of the tests (RFC 4180): rows as maps from
// column to cell.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace touchdown::testing {

class Row {
 public:
  std::map<std::string, std::string> cells;

  const std::string& Text(const std::string& column) const {
    const auto it = cells.find(column);
    if (it == cells.end()) throw std::out_of_range("no column " + column);
    return it->second;
  }
  bool Has(const std::string& column) const {
    const auto it = cells.find(column);
    return it != cells.end() && !it->second.empty();
  }
  // The `<stem>_hex` cell where there is one.
  double Number(const std::string& column) const {
    const std::string stem = column.substr(0, column.rfind('_'));
    const std::string hex = stem + "_hex";
    return std::strtod((Has(hex) ? Text(hex) : Text(column)).c_str(), nullptr);
  }
  long double Long(const std::string& column) const {
    return std::strtold(Text(column).c_str(), nullptr);
  }
};

inline std::vector<std::vector<std::string>> SplitCsv(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> row;
  std::string cell;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '"' && i + 1 < text.size() && text[i + 1] == '"') {
        cell += '"';
        ++i;
      } else if (c == '"') {
        quoted = false;
      } else {
        cell += c;
      }
    } else if (c == '"') {
      quoted = true;
    } else if (c == ',' || c == '\n') {
      row.push_back(cell);
      cell.clear();
      if (c == '\n') {
        rows.push_back(row);
        row.clear();
      }
    } else if (c != '\r') {
      cell += c;
    }
  }
  if (!cell.empty() || !row.empty()) {
    row.push_back(cell);
    rows.push_back(row);
  }
  return rows;
}

inline std::vector<Row> ParseCsv(const std::string& text) {
  std::vector<Row> out;
  const auto rows = SplitCsv(text);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i].size() <= 1) continue;
    Row row;
    for (std::size_t j = 0; j < rows[0].size() && j < rows[i].size(); ++j) {
      row.cells[rows[0][j]] = rows[i][j];
    }
    out.push_back(row);
  }
  return out;
}

inline std::vector<Row> ReadCsv(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return ParseCsv(text.str());
}

}  // namespace touchdown::testing
