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

// Decimals of u's second significant digit, 0 to 12: what a number known to u
// is printed with. 0.0996 rounds up to 0.10, which has two. Without u: 2.
int Decimals(double u);

// "20.013 ± 0.048": u with two significant digits, the value to the same
// decimals, both divided by `unit` (kDegree, kMillimetre). Without
// uncertainty (u = 0) the value alone, as Plain() prints it.
std::string WithU(const core::Estimate& estimate, double unit);

// The same of a difference: a positive one has its sign.
std::string DifferenceWithU(const core::Estimate& difference, double unit);

// A text of these with "+-", for terminals and fonts that lack the sign.
std::string InAscii(std::string text);

// WithU(), or "absent: reason".
std::string WithUOrReason(const core::Measured& measured, double unit);

// At most `decimals` decimals, without trailing zeros: "11.8", "43".
std::string Plain(double value, int decimals = 2);

// "+0.13", "-1.20", and "0.00" where it rounds to nothing.
std::string Signed(double value, int decimals);

// A probability to three decimals: "0.123", and "< 0.001" or "> 0.999" where
// 0.000 or 1.000 would claim certainty.
std::string Probability(double p);

// "[11.8, 27.4)"-like text of an interval with ends that may be absent:
// "from 11.8 on", "below 27.4", "anywhere". Divided by `unit`.
std::string HalfOpen(const std::optional<double>& low,
                     const std::optional<double>& high, double unit);

}  // namespace touchdown::report
