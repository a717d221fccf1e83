// Numbers out of text, the same whatever the locale.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace touchdown::report {

// The number that the whole of `text` is, with a decimal point where T has one;
// nothing where anything else is left over, or where a T does not hold it.
template <class T>
std::optional<T> ParseNumber(std::string_view text) {
  T value{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

}  // namespace touchdown::report
