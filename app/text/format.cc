#include "app/text/format.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace touchdown::report {
namespace {

// Without the sign of a zero.
std::string Rounded(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.find_first_not_of("-0.") == std::string::npos && text[0] == '-') {
    text.erase(0, 1);
  }
  return text;
}

bool IsZero(const std::string& number) {
  return number.find_first_not_of("0.") == std::string::npos;
}

}  // namespace

std::string Plain(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.find('.') != std::string::npos) {
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

int Decimals(double u) {
  if (!(u > 0.0) || !std::isfinite(u)) return 2;
  constexpr double kRoundsUp = 1.005;  // 9.95 has the digits of 10
  const int leading = static_cast<int>(std::floor(std::log10(u * kRoundsUp)));
  return std::clamp(1 - leading, 0, 12);
}

std::string WithU(const core::Estimate& estimate, double unit) {
  const double value = estimate.value / unit;
  const double u = estimate.u / std::abs(unit);
  if (!(u > 0.0) || !std::isfinite(u)) return Plain(value);
  const int decimals = Decimals(u);
  return fmt::format("{} {} {:.{}f}", Rounded(value, decimals), kPlusMinus, u,
                     decimals);
}

std::string DifferenceWithU(const core::Estimate& difference, double unit) {
  const std::string text = WithU(difference, unit);
  const bool is_plain =
      text.front() == '-' || IsZero(text.substr(0, text.find(' ')));
  return is_plain ? text : "+" + text;
}

std::string InAscii(std::string text) {
  const std::string_view sign = kPlusMinus;
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
  constexpr double kLeast = 0.0005;  // rounds to 0.001
  if (p < kLeast) return "< 0.001";
  if (p > 1.0 - kLeast) return "> 0.999";
  return fmt::format("{:.3f}", p);
}

std::string HalfOpen(const std::optional<double>& low,
                     const std::optional<double>& high, double unit) {
  if (low && high) {
    return fmt::format("[{}, {})", Plain(*low / unit), Plain(*high / unit));
  }
  if (low) return fmt::format("from {} on", Plain(*low / unit));
  if (high) return fmt::format("below {}", Plain(*high / unit));
  return "anywhere";
}

}  // namespace touchdown::report
