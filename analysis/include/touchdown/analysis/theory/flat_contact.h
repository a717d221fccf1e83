// Flush landing: a rectangle that lies with one side on the ground and slides
// (the paper's Fig. 3a, b). Two contacts, rear at -a/2 and front at +a/2 along
// x, the centre b/2 above them; the LCP of both normal forces in closed form.
//
//   y = M F/m - g,  M_ji = 1 + x_j (x_i - slip mu b/2) / k^2,  k^2 =
//   (a^2+b^2)/12
//
// With eta = b/a and tau = slip mu eta:
//   M_rr = 1 + 3 (1 + tau)/(1 + eta^2)    M_rf = 1 - 3 (1 - tau)/(1 + eta^2)
//   M_fr = 1 - 3 (1 + tau)/(1 + eta^2)    M_ff = 1 + 3 (1 - tau)/(1 + eta^2)
//   det M = 12 / (1 + eta^2)
//   |tau| <= 1   both carry: F_front = m g (1 + tau)/2, F_rear = m g (1 -
//   tau)/2 tau > 1      the rear lifts, the body tips over its front edge, if
//   M_ff > 0 M_ff < 0     no solution: Painleve's paradox in a flush landing,
//                mu > (4 a^2 + b^2)/(3 a b), at least 4/3 (at b = 2a)
// and the mirror image for tau < -1. There is never more than one solution. Of
// the tangential forces only the sum is determined.
//
// Valid for a rigid rectangle on level ground that does not rotate before.
#pragma once

#include <optional>
#include <string_view>

#include "touchdown/analysis/theory/corner.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {

struct FlatProblem {
  double length_m = 0.0;       // a, the side on the ground, > 0
  double height_m = 0.0;       // b, > 0
  double mu = 0.0;             // >= 0
  Slip slip = Slip::kLeading;  // +1: slides to +x, front leads; kNone: at rest
  double mass_kg = 1.0;        // > 0
  double gravity_mps2 = core::kStandardGravity_mps2;  // > 0
};

enum class Feet { kBoth, kFront, kRear };

// both, front, rear: the feet that carry.
std::string_view Name(Feet feet);

struct FlatSolution {
  Feet feet = Feet::kBoth;
  double rear_n = 0.0;        // normal forces
  double front_n = 0.0;       //
  double tangential_n = 0.0;  // sum of both feet, on the body
  double rear_mps2 = 0.0;     // normal accelerations of the feet
  double front_mps2 = 0.0;
};

struct FlatResult {
  double m_rr = 0.0, m_rf = 0.0, m_fr = 0.0, m_ff = 0.0;  // row: response
  double determinant = 0.0;
  double tipping = 0.0;  // tau; a foot lifts where |tau| > 1
  // |tau| - 1 or M_ff (M_rr) is zero within 8 u of its terms.
  bool within_tolerance = false;
  std::optional<FlatSolution> solution;  // nothing: inconsistent
};

// Throws std::invalid_argument for an argument outside its range.
FlatResult SolveFlatContact(const FlatProblem& problem);

}  // namespace touchdown::analysis
