#include "app/text/format.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace touchdown::report {
namespace {

// `value` with exactly so many decimals. A value that rounds to zero loses its
// minus: "-0.00" would claim a direction that nobody measured.
std::string Rounded(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.find_first_not_of("-0.") == std::string::npos && text[0] == '-') {
    text.erase(0, 1);
  }
  return text;
}

// Whether the printed digits of a number, without its sign, are all zeros.
bool IsZero(const std::string& number) {
  return number.find_first_not_of("0.") == std::string::npos;
}

}  // namespace

std::string Plain(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  // Only zeros behind a decimal point mean nothing; those of "40" stay.
  if (text.find('.') != std::string::npos) {
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
  }
  // A small negative value leaves "-0" behind.
  return text == "-0" ? "0" : text;
}

int Decimals(double u) {
  if (!(u > 0.0) || !std::isfinite(u)) return 2;
  // At two significant digits everything from 9.95 on prints as 10, whose first
  // digit stands one place higher. Without this factor it would have three
  // digits.
  constexpr double kRoundsUp = 1.005;  // 9.95 has the digits of 10
  const int leading = static_cast<int>(std::floor(std::log10(u * kRoundsUp)));
  // `leading` is the power of ten of the first digit: 0.048 has -2 and gets
  // three decimals. A u of 10 or more gets none.
  return std::clamp(1 - leading, 0, 12);
}

std::string WithU(const core::Estimate& estimate, double unit) {
  const double value = estimate.value / unit;
  // An uncertainty stays positive where the unit turns the sign of the value.
  const double u = estimate.u / std::abs(unit);
  // Without an uncertainty nothing says how many digits are known.
  if (!(u > 0.0) || !std::isfinite(u)) return Plain(value);
  const int decimals = Decimals(u);
  return fmt::format("{} {} {:.{}f}", Rounded(value, decimals), kPlusMinus, u,
                     decimals);
}

std::string DifferenceWithU(const core::Estimate& difference, double unit) {
  const std::string text = WithU(difference, unit);
  // A minus stands there already, and a difference of zero has no direction.
  // The value is the part of the text before the first space.
  const bool is_plain =
      text.front() == '-' || IsZero(text.substr(0, text.find(' ')));
  return is_plain ? text : "+" + text;
}

std::string InAscii(std::string text) {
  const std::string_view sign = kPlusMinus;
  // The sign has two bytes in UTF-8, so it is replaced as a string.
  for (std::size_t at = text.find(sign); at != std::string::npos;
       at = text.find(sign, at)) {
    text.replace(at, sign.size(), "+-");
  }
  return text;
}

std::string WithUOrReason(const core::Measured& measured, double unit) {
  return measured ? WithU(*measured, unit)
                  : "absent: " + measured.error().reason;
}

std::string Signed(double value, int decimals) {
  const std::string text = Rounded(value, decimals);
  return text.front() == '-' || IsZero(text) ? text : "+" + text;
}

std::string Probability(double p) {
  // Half of the last printed digit: smaller values would print as 0.000, and a
  // probability of exactly 0 or 1 is never known.
  constexpr double kLeast = 0.0005;  // rounds to 0.001
  if (p < kLeast) return "< 0.001";
  if (p > 1.0 - kLeast) return "> 0.999";
  return fmt::format("{:.3f}", p);
}

std::string HalfOpen(const std::optional<double>& low,
                     const std::optional<double>& high, double unit) {
  if (low && high) {
    // Half open as a bracket is: the low end belongs to the range, the high end
    // does not.
    return fmt::format("[{}, {})", Plain(*low / unit), Plain(*high / unit));
  }
  if (low) return fmt::format("from {} on", Plain(*low / unit));
  if (high) return fmt::format("below {}", Plain(*high / unit));
  return "anywhere";
}

}  // namespace touchdown::report
