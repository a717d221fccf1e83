#include "app/report/format.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace touchdown::report {

std::string Plain(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.find('.') != std::string::npos) {
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::string WithU(const core::Estimate& estimate, double unit) {
  const double value = estimate.value / unit;
  const double u = estimate.u / std::abs(unit);
  if (!(u > 0.0) || !std::isfinite(u)) return Plain(value);
  // Two significant digits of u, between 0 and 6 decimals.
  const int leading = static_cast<int>(std::floor(std::log10(u)));
  const int decimals = std::clamp(1 - leading, 0, 6);
  return fmt::format("{:.{}f} {} {:.{}f}", value, decimals, kPlusMinus, u,
                     decimals);
}

std::string WithUOrReason(const core::Measured& measured, double unit) {
  return measured ? WithU(*measured, unit)
                  : "absent: " + measured.error().reason;
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
