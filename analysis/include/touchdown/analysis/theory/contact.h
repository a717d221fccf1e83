// Contact of one corner with the ground, sliding or at rest: Eqs. (1)-(9) of
// the paper, corrected (frame, slip and the matrix G: corner.h; errata:
// docs/theory.md).
//
// With normal force F_n >= 0 and normal acceleration y = g_N'' >= 0 of P:
//   sliding, v_N = 0:   y = A_hat F_n / m + b,   y F_n = 0,   F_t = -slip mu
//   F_n
//     A_hat = 1 + kappa cos (cos - slip mu sin)        b = R omega^2 sin - g
//   (@cite Genot1999, @cite Champneys2016). One unknown: a linear
//   complementarity problem (LCP) with 0, 1 or 2 solutions, all of which are
//   returned:
//     A_hat > 0, b < 0   slide            F_n = -m b / A_hat
//     A_hat > 0, b > 0   detach           F_n = 0
//     A_hat < 0, b > 0   indeterminate    both; the sliding one is unstable
//     A_hat < 0, b < 0   inconsistent     none: impact without collision,
//                                         impact.h
//     b = 0              graze            F_n = 0, y = 0
//   at rest, v_T = 0: sticking force F_n/m = g G_TT/(1+kappa) - R omega^2 sin,
//   F_t/m = cos (R omega^2 - kappa sin g/(1+kappa)), valid in the friction cone
//   |F_t| <= mu F_n; else slip either way or detach: all four are examined.
//
// The theory speaks of a contact that exists, v_N = 0: omega and the slip are
// those after the impact. "Detach" is loss of a sustained contact, not the
// bounce that a camera sees (errata E9; boundary_models.h, detectable-bounce).
//
// Numbers. Signs are decided against rounding tolerances, u = 2^-53:
//   tol A_hat = 8 u (1 + kappa cos^2 + kappa mu |sin cos|)
//   tol b     = 8 u (R omega^2 |sin| + g)
// Inside them the answer is re-evaluated with 64 bits where alpha carries its
// low parts (SinCosOf... in corner.h). Products that leave the range of double
// (omega^2 = 1e400, R/k = 1e200) are taken with the exponent range of long
// double; 1/m is never formed. F_n is good to 16 u max(cond A_hat, cond b).
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "touchdown/analysis/theory/corner.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {

enum class Regime {
  kSlide,
  kDetach,
  kIndeterminate,
  kInconsistent,
  kGraze,
  kAZeroDetach,  // A_hat = 0, b > 0: detach
  kAZeroNone,    // A_hat = 0, b < 0: no solution
  kDegenerate,   // A_hat = 0, b = 0: every F_n >= 0
  kStick,        // from here on at rest
  kSlipLeading,
  kSlipTrailing,
  kStickOrSlip  // on the edge of the friction cone
};

// SLIDE, DETACH, INDETERMINATE, INCONSISTENT, GRAZE, A_ZERO_DETACH,
// A_ZERO_NONE, DEGENERATE, STICK, SLIP+, SLIP-, STICK_OR_SLIP.
std::string_view Name(Regime regime);

struct ContactProblem {
  SinCos alpha;
  double mu = 0.0;                 // >= 0
  Slip slip = Slip::kTrailing;     // kNone: at rest, v_T = 0
  double mass_kg = 1.0;            // > 0
  double radius_m = 0.0;           // R, > 0
  double kappa = 3.0;              // R^2/k^2, >= 0
  double gyration_radius_m = 0.0;  // k; if > 0, kappa = (R/k)^2 instead
  double omega_rad_per_s = 0.0;    // spin, of either sign
  double gravity_mps2 = core::kStandardGravity_mps2;  // >= 0
};

enum class SolutionKind {
  kDetach,
  kSlide,
  kStick,
  kSlipLeading,
  kSlipTrailing
};

// detach, slide, stick, slip+, slip-.
std::string_view Name(SolutionKind kind);

struct ContactSolution {
  SolutionKind kind = SolutionKind::kDetach;
  double normal_n = 0.0;         // F_n
  double tangential_n = 0.0;     // F_t on the body, along x
  double normal_mps2 = 0.0;      // g_N'' of P
  double tangential_mps2 = 0.0;  // g_T'' of P
  // |G_NN F_n/m + G_NT F_t/m + b_N - g_N''| over the sum of the terms' sizes.
  double residual = 0.0;
};

// How far each input alone may move, to first order, before A_hat or b changes
// sign; signed, in the input's unit; infinite where that input has no
// influence. Exact for mu, kappa, R and g, in which A_hat and b are linear.
struct ContactMargins {
  double a_hat_alpha_rad = 0.0;
  double a_hat_mu = 0.0;
  double a_hat_kappa = 0.0;
  double b_alpha_rad = 0.0;
  double b_omega_rad_per_s = 0.0;
  double b_radius_m = 0.0;
  double b_gravity_mps2 = 0.0;
  // At rest: mu - |F_t/F_n| of the sticking force; 0 while sliding.
  double cone_mu = 0.0;
};

struct ContactResult {
  // Of the numbers given: certified with 64 bits inside the tolerances where
  // that is possible, else equal to `tolerant_regime`.
  Regime regime = Regime::kSlide;
  // What remains if the inputs are rounded: the edge regimes within tolerance.
  Regime tolerant_regime = Regime::kSlide;
  bool within_tolerance = false;  // a deciding quantity lies within tolerance
  std::array<ContactSolution, 4> solution{};
  int n_solutions = 0;

  double a_hat = 0.0;  // 0 at rest, as its tolerance and condition
  double a_hat_tolerance = 0.0;
  double a_hat_condition = 0.0;
  double b_mps2 = 0.0;
  double b_tolerance_mps2 = 0.0;
  double b_condition = 0.0;
  ContactMargins margins;

  std::span<const ContactSolution> Solutions() const {
    return {solution.data(), static_cast<std::size_t>(n_solutions)};
  }
};

// A true sphere in these words. Its contact point is not fixed to the body: it
// stays below the centre, so g_N'' = F_n/m - g whatever angle, friction and
// spin (errata E5). Hence alpha = 90 deg and, in b, no omega.
ContactProblem SphereContact(double mass_kg, double radius_m, double kappa,
                             double mu, Slip slip, double gravity_mps2);

// All solutions, with conditions and margins. Throws std::invalid_argument for
// an argument outside its range.
ContactResult SolveContact(const ContactProblem& problem);

// The answer alone, for maps and simulators: the regime within the tolerances
// and F_n / m of the sliding solution (0 where there is none). Checks nothing;
// expects problem.slip != kNone. See tests/benchmarks for its time.
struct QuickContact {
  Regime regime = Regime::kSlide;
  double normal_per_mass_mps2 = 0.0;
};
QuickContact SolveSlidingContact(const ContactProblem& problem);

// The wedge of alpha in which A_hat < 0 on the leading corner; its edges are
// the roots of tan^2 a - kappa mu tan a + 1 + kappa = 0. `exists` is false for
// mu < mu_c = 2 sqrt(1 + kappa) / kappa, where both edges meet at tan alpha =
// sqrt(1 + kappa); 4/3 at 63.43 deg for a rectangle. kappa > 0.
struct Wedge {
  bool exists = false;
  double low_rad = 0.0;
  double high_rad = 0.0;
};
Wedge PainleveWedge(double kappa, double mu);

}  // namespace touchdown::analysis
