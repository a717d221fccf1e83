// Values as they are typed at the command line. Each throws
// std::invalid_argument with the flag's name, what was given and what is
// expected.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "touchdown/core/estimate.h"

namespace touchdown::cli {

// "40" or "40+-0.02", in SI by `unit`. Where no uncertainty is stated it is
// `relative_u` of the value.
core::Estimate ParseEstimate(const std::string& flag, const std::string& text,
                             double unit, double relative_u = 0.0);

// "60x20" or "60+-0.02x20+-0.02", likewise.
std::pair<core::Estimate, core::Estimate> ParseSides(const std::string& flag,
                                                     const std::string& text,
                                                     double unit,
                                                     double relative_u = 0.0);

// Exactly `count` numbers separated by commas.
std::vector<double> ParseNumbers(const std::string& flag,
                                 const std::string& text, std::size_t count,
                                 const std::string& form);

// "A:B", "A:" or ":B": frames A, A+1, ... B-1; an open end is -1.
std::pair<std::int64_t, std::int64_t> ParseFrames(const std::string& flag,
                                                  const std::string& text);

}  // namespace touchdown::cli
