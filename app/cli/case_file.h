// Case files: CSV tables of inputs that a command answers row by row, so that
// anyone can judge the program on cases of their own.
//
//   const CaseTable table = ReadCases("cases.csv");
//   CaseWriter out({"id", "v_full"});
//   for (const CaseRow& row : table.rows) {
//     out.Add({row.Text("id"), Cell(Speed(row.Number("m"), ...))});
//   }
//   WriteResult(out.Csv(), out_path);
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace touchdown::cli {

// One row. Every complaint is a core::InputError that names the file, the line
// and the column.
class CaseRow {
 public:
  struct Header {
    std::string file;
    std::vector<std::string> columns;
  };
  CaseRow(std::shared_ptr<const Header> header, std::size_t line,
          std::vector<std::string> cells);

  bool HasColumn(std::string_view column) const;
  // The cell as it stands; empty cells are allowed.
  const std::string& Text(std::string_view column) const;
  // A finite number, decimal or hexadecimal (0x1.8p+1). Where the row has the
  // same quantity in hexadecimal (`alpha_hex` beside `alpha_rad` or `alpha`),
  // that wins: it is exact.
  double Number(std::string_view column) const;
  // Nothing where the column is missing or the cell empty.
  std::optional<double> OptionalNumber(std::string_view column) const;
  // A whole number from a list, e.g. -1, 0 or 1.
  int Choice(std::string_view column, const std::vector<int>& allowed) const;

  // Runs `answer`; what it finds impossible (std::invalid_argument) becomes a
  // complaint about this row.
  void Answer(const std::function<void()>& answer) const;
  // Complains about one cell.
  [[noreturn]] void Refuse(std::string_view column,
                           std::string_view expected) const;

 private:
  std::optional<std::size_t> Find(std::string_view column) const;
  std::optional<std::size_t> FindNumber(std::string_view column) const;
  double Parse(std::size_t index) const;

  std::shared_ptr<const Header> header_;
  std::size_t line_;
  std::vector<std::string> cells_;
};

struct CaseTable {
  std::shared_ptr<const CaseRow::Header> header;
  std::vector<CaseRow> rows;

  bool HasColumn(std::string_view column) const;
};

// Reads a CSV file (RFC 4180, UTF-8) with a header and at least one row, and
// checks that it has `columns`. Throws core::InputError.
CaseTable ReadCases(const std::string& path,
                    const std::vector<std::string>& columns);

// A number with all its digits; empty for NaN.
std::string Cell(double value);
std::string Cell(std::optional<double> value);
std::string Cell(int value);
std::string Cell(std::string_view value);

class CaseWriter {
 public:
  explicit CaseWriter(const std::vector<std::string>& columns);
  // As many cells as there are columns.
  void Add(const std::vector<std::string>& cells);
  const std::string& Csv() const { return csv_; }

 private:
  std::size_t n_columns_;
  std::string csv_;
};

// Writes to `path`, whole or not at all (a temporary file beside it is
// renamed), or to standard output where `path` is empty. Throws
// core::InputError.
void WriteResult(std::string_view text, const std::string& path);

}  // namespace touchdown::cli
