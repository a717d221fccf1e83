// Numbers as reports print them.
#pragma once

#include <optional>
#include <string>

#include "touchdown/core/estimate.h"

namespace touchdown::report {

// The sign between a value and its uncertainty (UTF-8).
inline constexpr const char* kPlusMinus = "\u00b1";
// Between the ends of a range (UTF-8 en dash).
inline constexpr const char* kDash = "\u2013";

// "20.013 ± 0.048": u with two significant digits, the value to the same
// decimals, both divided by `unit` (kDegree, kMillimetre). Without
// uncertainty (u = 0) the value alone, as Plain() prints it.
std::string WithU(const core::Estimate& estimate, double unit);

// WithU(), or "absent: reason".
std::string WithUOrReason(const core::Measured& measured, double unit);

// At most `decimals` decimals, without trailing zeros: "11.8", "43".
std::string Plain(double value, int decimals = 2);

// "[11.8, 27.4)"-like text of an interval with ends that may be absent:
// "from 11.8 on", "below 27.4", "anywhere". Divided by `unit`.
std::string HalfOpen(const std::optional<double>& low,
                     const std::optional<double>& high, double unit);

}  // namespace touchdown::report
