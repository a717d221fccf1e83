// A measured number: value and standard uncertainty, or absent with a reason.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "touchdown/core/expected.h"

namespace touchdown::core {

// An interval that contains the true value with probability 0.95.
struct Interval {
  double low = 0.0;
  double high = 0.0;

  friend bool operator==(const Interval&, const Interval&) = default;
};

// 0.975 quantile of the standard normal distribution.
inline constexpr double kNormal975 = 1.959963984540054;

// `u` is the standard uncertainty (JCGM 100), in the unit of `value`, >= 0.
// `interval95` is set only where value +- 1.96 u would mislead: few frames, or
// a value near a bound.
struct Estimate {
  double value = 0.0;
  double u = 0.0;
  std::optional<Interval> interval95 = std::nullopt;

  friend bool operator==(const Estimate&, const Estimate&) = default;
};

// The 95 % interval of an estimate: its own, or the normal one.
inline Interval Interval95(const Estimate& e) {
  if (e.interval95) return *e.interval95;
  return {e.value - kNormal975 * e.u, e.value + kNormal975 * e.u};
}

// The same quantity in another unit: `factor` new units per old unit.
inline Estimate Scaled(const Estimate& e, double factor) {
  Estimate out{e.value * factor, e.u * std::abs(factor), std::nullopt};
  if (e.interval95) {
    const double a = e.interval95->low * factor;
    const double b = e.interval95->high * factor;
    out.interval95 = Interval{std::fmin(a, b), std::fmax(a, b)};
  }
  return out;
}

// Two measurements of one quantity as one: their mean, weighted by 1/u^2. Where
// they differ by more than their u, both get the same further variance,
//   tau^2 = ((a - b)^2 - u_a^2 - u_b^2) / 2,
// that makes them agree (Mandel and Paule, Anal. Chem. 42, 1970, 1194): the
// better claim no longer wins, and u covers either.
inline Estimate Combined(const Estimate& a, const Estimate& b) {
  constexpr double kLeast = 1e-18;  // of u^2: a convention has none
  const double aa = std::fmax(a.u * a.u, kLeast);
  const double bb = std::fmax(b.u * b.u, kLeast);
  const double d = a.value - b.value;
  const double more = std::fmax(0.0, 0.5 * (d * d - aa - bb));
  const double wa = 1.0 / (aa + more);
  const double wb = 1.0 / (bb + more);
  return {(a.value * wa + b.value * wb) / (wa + wb), 1.0 / std::sqrt(wa + wb),
          std::nullopt};
}

// The difference of two measurements of one quantity in its own u.
inline double Disagreement(const Estimate& a, const Estimate& b) {
  const double u = std::hypot(a.u, b.u);
  return u > 0.0 ? std::abs(a.value - b.value) / u : 0.0;
}

// Standard deviations by which what is seen differs from what was stated, or
// from nothing, before that is acted upon. 4: one right clip of 16 000. Larger
// lets a wrong scale pass; smaller doubts right ones, whose u is rarely better
// known.
inline constexpr double kBeyondDoubt = 4.0;

// Every measured number is present with its uncertainty or absent with a
// reason; a number that was not measured is never 0.
using Measured = Expected<Estimate>;

// One line of an uncertainty budget, in the unit of the budgeted quantity.
struct BudgetLine {
  std::string source;
  double u = 0.0;

  friend bool operator==(const BudgetLine&, const BudgetLine&) = default;
};
using Budget = std::vector<BudgetLine>;

}  // namespace touchdown::core
