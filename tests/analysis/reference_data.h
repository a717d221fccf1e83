// Reads the small CSV files of reference data.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "touchdown/analysis/statistics/observation.h"

namespace touchdown::analysis {

// Cells of a CSV, quotes removed and respected; comments (#) and empty lines
// are skipped, the heading is row 0.
inline std::vector<std::vector<std::string>> ReadCsv(
    const std::filesystem::path& path) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') {
        quoted = !quoted;
      } else if (c == ',' && !quoted) {
        cells.emplace_back();
      } else if (c != '\r') {
        cells.back() += c;
      }
    }
    rows.push_back(std::move(cells));
  }
  return rows;
}

// A trial in any unit: the arithmetic of a fit does not know degrees.
inline Observation Raw(double x, bool bounced, double u = 0.0) {
  Observation o;
  o.angle_rad = x;
  o.u_rad = u;
  o.p_bounce = bounced ? 1.0 : 0.0;
  o.outcome = bounced ? Outcome::kBounce : Outcome::kNotBounce;
  return o;
}

// Columns x, y of a data file; `x_of` changes the unit (a logarithm, say).
template <class F>
std::vector<Observation> ReadTrials(const std::filesystem::path& path, F x_of) {
  std::vector<Observation> out;
  const auto rows = ReadCsv(path);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const int count = rows[i].size() > 2 ? std::stoi(rows[i][2]) : 1;
    for (int k = 0; k < count; ++k) {
      out.push_back(Raw(x_of(std::stod(rows[i][0])), rows[i][1] == "1"));
    }
  }
  return out;
}

inline std::vector<Observation> ReadTrials(const std::filesystem::path& path) {
  return ReadTrials(path, [](double x) { return x; });
}

// Grouped data: columns x, n, k or x, k, n (`k_first`).
template <class F>
std::vector<Observation> ReadGroups(const std::filesystem::path& path,
                                    bool k_first, F x_of) {
  std::vector<Observation> out;
  const auto rows = ReadCsv(path);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double x = x_of(std::stod(rows[i][0]));
    const int a = std::stoi(rows[i][1]);
    const int b = std::stoi(rows[i][2]);
    const int n = k_first ? b : a;
    const int k = k_first ? a : b;
    for (int j = 0; j < n; ++j) out.push_back(Raw(x, j < k));
  }
  return out;
}

}  // namespace touchdown::analysis
