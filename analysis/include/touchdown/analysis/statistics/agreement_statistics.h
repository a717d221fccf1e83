// Numbers that say how well two things agree: proportions, tables of counts, a
// value and its reference.
#pragma once

#include "touchdown/core/estimate.h"

namespace touchdown::analysis {

// --- a proportion, x of n
// ----------------------------------------------------- All throw
// std::invalid_argument unless 0 <= x <= n, n >= 1, 0 < level < 1.

// Wilson's score interval (Newcombe 1998, method 3), two-sided.
core::Interval WilsonInterval(int x, int n, double level = 0.95);

// Clopper and Pearson's exact interval (Newcombe 1998, method 5), two-sided.
core::Interval ClopperPearsonInterval(int x, int n, double level = 0.95);

// --- two ratings of the same trials ------------------------------------------

// Counts of two yes/no ratings: a both yes, b yes/no, c no/yes, d both no.
struct TwoByTwo {
  int a = 0;
  int b = 0;
  int c = 0;
  int d = 0;
  int total() const { return a + b + c + d; }
};

// Cohen's kappa with the standard errors of Fleiss, Cohen and Everitt (1969):
// `ase` at the estimate, `ase0` if there were no agreement but by chance (for
// tests).
struct CohensKappa {
  double kappa = 0.0;
  double ase = 0.0;
  double ase0 = 0.0;
};

// Throws std::invalid_argument unless counts are >= 0 and their sum is
// positive. Where all lies in one category kappa is undefined: all three are
// NaN.
CohensKappa CohenKappa(const TwoByTwo& table);

// Matthews' correlation (the phi coefficient); NaN where a margin is empty.
double MatthewsCorrelation(const TwoByTwo& table);

// Do two methods label the same trials differently? From the discordant counts
// b and c alone.
struct McNemar {
  double p_exact = 1.0;  // two-sided binomial
  double p_mid = 1.0;    // mid-p (Fagerland et al. 2013)
};
McNemar McNemarTest(int b, int c);

// --- a measured value and a reference value ----------------------------------

// E_n of ISO 13528: (value - reference) / sqrt(U^2 + U_ref^2), with expanded
// uncertainties. |E_n| <= 1 is called compatible. Throws unless U^2 + U_ref^2 >
// 0.
double NormalizedError(double value, double expanded_u, double reference,
                       double reference_expanded_u);

}  // namespace touchdown::analysis
