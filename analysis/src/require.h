// Checks of arguments: an impossible one throws std::invalid_argument that
// names the field, its value and its allowed range.
#pragma once

#include <fmt/core.h>

#include <cmath>
#include <stdexcept>
#include <string_view>

namespace touchdown::analysis {

[[noreturn]] inline void Refuse(std::string_view field, double value,
                                std::string_view unit, std::string_view range) {
  throw std::invalid_argument(fmt::format("{} is {}{}{}, must be {}", field,
                                          value, unit.empty() ? "" : " ", unit,
                                          range));
}

inline void Require(bool ok, std::string_view field, double value,
                    std::string_view range) {
  if (!ok) Refuse(field, value, "", range);
}

inline void RequireFinite(std::string_view field, double value,
                          std::string_view unit = "") {
  if (!std::isfinite(value)) Refuse(field, value, unit, "finite");
}

inline void RequirePositive(std::string_view field, double value,
                            std::string_view unit = "") {
  if (!(value > 0.0) || !std::isfinite(value)) {
    Refuse(field, value, unit, "positive and finite");
  }
}

inline void RequireNotNegative(std::string_view field, double value,
                               std::string_view unit = "") {
  if (!(value >= 0.0) || !std::isfinite(value)) {
    Refuse(field, value, unit, "at least 0 and finite");
  }
}

inline void RequireBetween(std::string_view field, double value, double low,
                           double high, std::string_view unit = "") {
  if (!(value >= low && value <= high)) {
    Refuse(field, value, unit, fmt::format("from {} to {}", low, high));
  }
}

}  // namespace touchdown::analysis
