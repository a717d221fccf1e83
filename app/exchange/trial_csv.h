// Trials as CSV (RFC 4180, UTF-8, one header row), for spreadsheets and for
// trials logged on paper. Degrees and millimetres, the unit in each column's
// name. A flat view of the current revisions: reasons of absence, intervals,
// budgets, later contacts and history are not in it (trial_json.h has all).
#pragma once

#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include "touchdown/core/trial.h"

namespace touchdown::report {

// The columns, in order; `touchdown import --columns` prints them.
struct CsvColumn {
  std::string name;
  std::string meaning;
  bool is_number = false;  // else a text or a word
};
const std::vector<CsvColumn>& TrialCsvColumns();

// A cell that a spreadsheet would run as a formula is written with an
// apostrophe before it; ReadTrialsCsv takes it away again.
void WriteTrialsCsv(std::ostream& out, std::span<const core::Trial> trials);

struct CsvTrial {
  std::size_t row = 0;  // the header is row 1
  core::Trial trial;
};

struct CsvTrials {
  std::vector<CsvTrial> trials;     // of the rows that are right
  std::vector<std::string> errors;  // "FILE: row 7, column state: ..."
};

// Reads trials to be logged. body_kind and state must be there; origin is
// `manual` and the author `author` where the columns are absent or empty; empty
// cells of measured numbers are absent, "not recorded". Columns in any order.
// Throws core::InputError if the header is unusable (a column is unknown, comes
// twice or bears another unit) or a quote is left open; `name` is the file's.
CsvTrials ReadTrialsCsv(std::istream& in, const std::string& name,
                        const std::string& author);

}  // namespace touchdown::report
