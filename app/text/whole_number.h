// Whole numbers out of JSON that others wrote: nlohmann::json converts a number
// with a fraction, or one that does not fit, without a word.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <stdexcept>

namespace touchdown::pipeline {

// `name`: of the field, for the message. Throws std::invalid_argument unless
// `json` is a whole number that a T holds.
template <class T = std::int64_t, class Json>
T WholeNumber(const Json& json, const char* name) {
  constexpr std::int64_t kLeast = std::numeric_limits<T>::min();
  constexpr std::int64_t kMost = std::numeric_limits<T>::max();
  const bool too_large =
      json.is_number_unsigned() &&
      json.template get<std::uint64_t>() > static_cast<std::uint64_t>(kMost);
  if (json.is_number_integer() && !too_large) {
    const auto value = json.template get<std::int64_t>();
    if (value >= kLeast && value <= kMost) return static_cast<T>(value);
  }
  throw std::invalid_argument(
      fmt::format("{} is {}, must be a whole number from {} to {}", name,
                  json.dump(), kLeast, kMost));
}

}  // namespace touchdown::pipeline
