// Numbers that say how well two things agree: proportions, tables of counts,
// equivalence.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "touchdown/core/estimate.h"

namespace touchdown::analysis {

// --- a proportion, x of n
// ----------------------------------------------------- All throw
// std::invalid_argument unless 0 <= x <= n, n >= 1, 0 < level < 1.

// Wilson's score interval (Newcombe 1998, method 3), two-sided.
core::Interval WilsonInterval(int x, int n, double level = 0.95);

// Clopper and Pearson's exact interval (Newcombe 1998, method 5), two-sided.
core::Interval ClopperPearsonInterval(int x, int n, double level = 0.95);

// Its one-sided lower limit: the proportion is above it with `level`.
double ClopperPearsonLowerLimit(int x, int n, double level = 0.95);

// --- two ratings of the same trials ------------------------------------------
// Counts by [first][second], row by row, `k` categories: k * k numbers.

enum class KappaWeights { kNone, kLinear };

// Cohen's kappa with the standard errors of Fleiss, Cohen and Everitt (1969):
// `ase` at the estimate, `ase0` if there were no agreement but by chance (for
// tests). Linear weights are 1 - |i - j| / (k - 1).
struct CohensKappa {
  double kappa = 0.0;
  double ase = 0.0;
  double ase0 = 0.0;
};

// Throws std::invalid_argument unless counts are >= 0, their sum is positive
// and there are k * k of them, k >= 2. Where all lies in one category kappa is
// undefined: NaN with `ase` NaN.
CohensKappa CohenKappa(std::span<const int> counts, int k,
                       KappaWeights weights = KappaWeights::kNone);

// Counts of two yes/no ratings: a both yes, b yes/no, c no/yes, d both no.
struct TwoByTwo {
  int a = 0;
  int b = 0;
  int c = 0;
  int d = 0;
  int total() const { return a + b + c + d; }
};

// Matthews' correlation (the phi coefficient); NaN where a margin is empty.
double MatthewsCorrelation(const TwoByTwo& table);

// Do two methods label the same trials differently? From the discordant counts
// b and c alone.
struct McNemar {
  double chi_square = 0.0;            // (b - c)^2 / (b + c)
  double chi_square_corrected = 0.0;  // (|b - c| - 1)^2 / (b + c)
  double p_corrected = 1.0;           // of the corrected chi square
  double p_exact = 1.0;               // two-sided binomial
  double p_mid = 1.0;                 // mid-p (Fagerland et al. 2013)
};
McNemar McNemarTest(int b, int c);

// Fisher's exact test of a 2 x 2 table; two-sided by summing all tables that
// are no more probable (as R does). It says only that outcome depends on
// prediction: any threshold inside the bracket has the same p.
struct Fisher {
  double p_greater = 1.0;  // odds ratio above 1
  double p_two_sided = 1.0;
};
Fisher FisherExactTest(const TwoByTwo& table);

// --- a measured value and a reference value ----------------------------------

// E_n of ISO 13528: (value - reference) / sqrt(U^2 + U_ref^2), with expanded
// uncertainties. |E_n| <= 1 is called compatible. Throws unless U^2 + U_ref^2 >
// 0.
double NormalizedError(double value, double expanded_u, double reference,
                       double reference_expanded_u);

// Two one-sided tests of |value - reference| >= margin (Schuirmann 1987):
// equivalent at level alpha where both p are below it, which is the same as the
// 1 - 2 alpha interval lying within reference +- margin.
struct Equivalence {
  double statistic_lower = 0.0;  // (value - reference + margin) / se
  double statistic_upper = 0.0;  // (value - reference - margin) / se
  double p_lower = 1.0;
  double p_upper = 1.0;
  bool equivalent = false;  // both below alpha
};

// From a value with its standard error, normal theory.
Equivalence EquivalenceZ(double value, double standard_error, double reference,
                         double margin, double alpha = 0.05);

// From the mean and standard deviation of n values, Student's theory.
Equivalence EquivalenceT(double mean, double sd, int n, double reference,
                         double margin, double alpha = 0.05);

// The least margin at which EquivalenceZ passes.
double SmallestEquivalenceMargin(double value, double standard_error,
                                 double reference, double alpha = 0.05);

}  // namespace touchdown::analysis
