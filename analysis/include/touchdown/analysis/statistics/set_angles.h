// What was set says where a body came down, beside what was measured.
//
// A measured angle x of a trial set to c scatters for three reasons:
//   x = c + a + b + e + m
//   a   the ejector's offset in this set-up, unknown
//   b   its deviation from a at this set angle, N(0, between^2)
//   e   its repeatability, N(0, within^2): the body came down elsewhere
//   m   the error of the measurement, N(0, u^2): it did not
// To take x at its word (the classical error) puts the boundary too far from
// angles that are set often, and takes m for scatter of the boundary. The
// remedy is Berkson's (statistics.md section 1.2): what is expected of the true
// angle, given all r = x - c of the set-up. For a set angle of n trials and
// mean r_s,
//   v   = (within^2 + u^2) / n
//   B   = between^2 / (between^2 + v)
//   m_s = a + B (r_s - a),   var(m_s) = B v + (1 - B)^2 var(a)
//   k   = within^2 / (within^2 + u^2)
//   x'  = c + m_s + k (r - m_s)
//   u'^2 = k u^2 + (1 - k)^2 var(m_s)
// a is the mean of the r_s with weights 1 / (between^2 + v), and var(a) one
// over their sum. The variances are those of the analysis of variance, without
// what u explains. Where set angles differ by no more than their repeats do,
// both are pooled and between is 0 (@cite Thompson1962). An ejector that does
// not do what it is told has a great `between`, and each set angle keeps its
// own mean; a set angle of one trial then keeps its measured angle and its u.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "touchdown/analysis/statistics/observation.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {

struct SetAngleOptions {
  // The ejector's repeatability as it is believed before the trials, and how
  // many trials that belief is worth beside what their scatter says: few enough
  // that ten trials speak for themselves.
  double set_u_rad = 0.5 * core::kDegree;
  double worth_trials = 4.0;
};

struct SetAngleUse {
  std::vector<Observation> observations;  // in the order given
  int used = 0;                           // trials whose set angle has a say
  // The ejector's repeatability, and its deviation from one set angle to
  // another; absent where no set angle has a say.
  std::optional<double> within_rad;
  std::optional<double> between_rad;
};

// Set angles are equal where they differ by less than kSameAngle_rad; set-ups
// are apart. Angles that were typed and not measured stay as they are: those of
// repeats that are all the same, and one alone that is the set angle itself. So
// do those of a set-up with one measured trial. Throws std::invalid_argument
// naming the option that is out of its range.
SetAngleUse UseSetAngles(std::span<const Observation> observations,
                         const SetAngleOptions& options = {});

}  // namespace touchdown::analysis
