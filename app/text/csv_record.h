// Tables as CSV (RFC 4180), record by record.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace touchdown::report {

// Spreadsheets begin UTF-8 files with a byte order mark.
void SkipByteOrderMark(std::istream& in);

// The cells of the next record (RFC 4180, section 2); nothing at the end of the
// file. Throws core::InputError naming file and row if a quote is left open.
std::optional<std::vector<std::string>> ReadCsvRecord(std::istream& in,
                                                      const std::string& name,
                                                      std::size_t row);

// The inverse of what CsvCell (text.h) does against formulas: the apostrophe
// before = + - @ is taken away.
std::string CsvCellText(std::string cell);

}  // namespace touchdown::report
