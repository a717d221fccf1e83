#include "app/cli/values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "app/text/parse_number.h"

namespace touchdown::cli {
namespace {

// Throws the message of every value: "--region is '1,2', must be X,Y,W,H ...".
[[noreturn]] void Refuse(const std::string& flag, const std::string& text,
                         const std::string& form) {
  throw std::invalid_argument(
      fmt::format("{} is '{}', must be {}", flag, text, form));
}

// Returns the parts between the separators; one more than there are separators,
// and empty where two follow each other.
std::vector<std::string_view> Split(std::string_view text, char at) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t end = text.find(at);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

}  // namespace

std::vector<double> ParseNumbers(const std::string& flag,
                                 const std::string& text, std::size_t count,
                                 const std::string& form) {
  std::vector<double> numbers;
  for (const std::string_view part : Split(text, ',')) {
    const auto number = report::ParseNumber<double>(part);
    if (!number || !std::isfinite(*number)) Refuse(flag, text, form);
    numbers.push_back(*number);
  }
  if (numbers.size() != count) Refuse(flag, text, form);
  return numbers;
}

core::PixelRect ParseRegion(const std::string& flag, const std::string& text) {
  // No picture that is read has longer sides, and all sums stay within an
  // int32.
  constexpr double kMaxSidePx = 65536.0;
  const std::string form = "X,Y,W,H in whole pixels, W and H positive";
  const auto n = ParseNumbers(flag, text, 4, form);
  // The corner may be at 0; a side of 0 would be no region.
  for (std::size_t i = 0; i < n.size(); ++i) {
    const double least = i < 2 ? 0.0 : 1.0;
    if (!(n[i] >= least && n[i] <= kMaxSidePx) || n[i] != std::floor(n[i])) {
      Refuse(flag, text, form);
    }
  }
  return {static_cast<std::int32_t>(n[0]), static_cast<std::int32_t>(n[1]),
          static_cast<std::int32_t>(n[2]), static_cast<std::int32_t>(n[3])};
}

std::pair<std::int64_t, std::int64_t> ParseFrames(const std::string& flag,
                                                  const std::string& text) {
  const std::string form = "first and one past the last frame, as in 18:33";
  const auto parts = Split(text, ':');
  if (parts.size() != 2) Refuse(flag, text, form);
  // An open end means frame 0, or the last frame (-1).
  std::pair<std::int64_t, std::int64_t> range{0, -1};
  if (!parts[0].empty()) {
    const auto first = report::ParseNumber<std::int64_t>(parts[0]);
    if (!first || *first < 0) Refuse(flag, text, form);
    range.first = *first;
  }
  if (!parts[1].empty()) {
    const auto last = report::ParseNumber<std::int64_t>(parts[1]);
    if (!last || *last <= range.first) Refuse(flag, text, form);
    range.second = *last;
  }
  return range;
}

}  // namespace touchdown::cli
