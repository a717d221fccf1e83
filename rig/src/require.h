// Preconditions: the first error lane, one wording for the whole module.
#pragma once

#include <fmt/core.h>

#include <cmath>
#include <stdexcept>

namespace touchdown::rig {

[[noreturn]] inline void Refuse(const char* field, double value,
                                const char* allowed) {
  throw std::invalid_argument(
      fmt::format("{} is {:g}, must be {}", field, value, allowed));
}

inline void RequirePositive(const char* field, double value) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    Refuse(field, value, "positive and finite");
  }
}

inline void RequireAtLeastZero(const char* field, double value) {
  if (!(value >= 0.0) || !std::isfinite(value)) {
    Refuse(field, value, "at least 0 and finite");
  }
}

inline void RequireFinite(const char* field, double value) {
  if (!std::isfinite(value)) Refuse(field, value, "finite");
}

}  // namespace touchdown::rig
