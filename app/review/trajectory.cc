#include "app/review/trajectory.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

namespace touchdown::review {
namespace {

using Json = nlohmann::json;

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
  const Json document = Json::parse(trial.document_json, nullptr, false);
  if (!document.is_object() || !document.contains("path")) {
    return core::AbsentBecause(
        "its analysis has no path in millimetres: no body, no ground or no "
        "scale was found, or an earlier program made it");
  }
  try {
    const Json& path = document["path"];
    std::string csv = Line(path.at("columns").get<std::string>());
    for (const Json& row : path.at("rows")) csv += Line(row.get<std::string>());
    return csv;
  } catch (const Json::exception&) {
    return core::AbsentBecause("the path in its document is damaged");
  }
}

}  // namespace touchdown::review
