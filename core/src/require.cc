#include "touchdown/core/require.h"

#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string>

namespace touchdown::core {
namespace {

// The shortest digits that give the number again.
std::string ShortestDigits(double value) {
  std::array<char, 32> digits;
  const auto end =
      std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return {digits.data(), end.ptr};
}

}  // namespace

void Refuse(std::string_view field, double value, std::string_view range,
            std::string_view unit) {
  std::string text(field);
  text += " is " + ShortestDigits(value);
  if (!unit.empty()) text.append(" ").append(unit);
  text.append(", must be ").append(range);
  throw std::invalid_argument(text);
}

void Require(bool ok, std::string_view field, double value,
             std::string_view range) {
  if (!ok) Refuse(field, value, range);
}

void RequireFinite(std::string_view field, double value,
                   std::string_view unit) {
  if (!std::isfinite(value)) Refuse(field, value, "finite", unit);
}

void RequirePositive(std::string_view field, double value,
                     std::string_view unit) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    Refuse(field, value, "positive and finite", unit);
  }
}

void RequireNotNegative(std::string_view field, double value,
                        std::string_view unit) {
  if (!(value >= 0.0) || !std::isfinite(value)) {
    Refuse(field, value, "at least 0 and finite", unit);
  }
}

void RequireInRange(std::string_view field, double value, double low,
                    double high, std::string_view unit) {
  if (!(value >= low && value <= high)) {
    Refuse(field, value,
           "from " + ShortestDigits(low) + " to " + ShortestDigits(high), unit);
  }
}

}  // namespace touchdown::core
