#include "app/review/trajectory.h"

#include <algorithm>
#include <sstream>

#include "app/facts/stored_document.h"

namespace touchdown::review {
namespace {

// "1 0.5 null" to "1,0.5,"
std::string Line(const std::string& cells) {
  std::istringstream in(cells);
  std::string line;
  std::string cell;
  for (bool first = true; in >> cell; first = false) {
    if (!first) line += ',';
    if (cell != "null") line += cell;
  }
  return line + "\r\n";
}

}  // namespace

core::Expected<std::string> TrajectoryCsv(const core::Trial& trial) {
  if (trial.document_json.empty()) {
    return core::AbsentBecause("the trial was logged by hand");
  }
  // The document has numbers with blanks between; CSV wants commas.
  const auto document = report::StoredDocument(trial);
  if (!document.contains("path")) {
    return core::AbsentBecause(
        "its analysis has no path in millimetres: no body, no ground or no "
        "scale was found, or an earlier program made it");
  }
  try {
    const auto& path = document["path"];
    std::string csv = Line(path.at("columns").get<std::string>());
    for (const auto& row : path.at("rows")) csv += Line(row.get<std::string>());
    return csv;
  } catch (const nlohmann::json::exception&) {
    return core::AbsentBecause("the path in its document is damaged");
  }
}

}  // namespace touchdown::review
