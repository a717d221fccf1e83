// CSV files that a command reads: RFC 4180, one header row.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace touchdown::cli {

struct Row {
  std::size_t line = 0;  // in the file, counted from 1
  std::vector<std::string> cells;
};

// A table of text; numbers are made where they are asked for, so that an error
// can name file, line and column.
class Table {
 public:
  // Throws core::InputError where the file cannot be read, has no header, a row
  // has another number of cells than the header, or a quote is left open.
  explicit Table(const std::filesystem::path& path);

  const std::vector<Row>& rows() const { return rows_; }
  const std::string& path() const { return path_; }
  bool Has(std::string_view column) const;

  // Throws core::InputError where there is no such column.
  const std::string& Text(const Row& row, std::string_view column) const;

  // The exact double of `column`_hex where that column is there and filled,
  // else of `column`. Throws core::InputError unless it is a finite number.
  double Number(const Row& row, std::string_view column) const;

  // The same; nothing where column or cell is missing.
  std::optional<double> OptionalNumber(const Row& row,
                                       std::string_view column) const;

 private:
  std::optional<std::size_t> Find(std::string_view column) const;

  std::string path_;
  std::vector<std::string> header_;
  std::vector<Row> rows_;
};

}  // namespace touchdown::cli
