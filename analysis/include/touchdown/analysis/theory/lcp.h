// Small linear complementarity problems, solved by looking at every basis:
//   find z >= 0 with w = M z + q >= 0 and z_i w_i = 0 for all i.
//
// A pivoting or iterative solver returns one solution or fails for reasons of
// its own; here none, one, several and a continuum are told apart. Contact with
// friction needs that: its M is neither symmetric nor definite, and 0 or 2
// solutions are physics. Up to 8 unknowns, by 2^n bases
// (@cite Cottle2009, sec. 1.3 and 4.1). Used where no closed form serves
// (contact.h and flat_contact.h have one).
//
// Arithmetic is in long double on the rows and columns of M scaled by powers of
// two. M and q count as known to rounding of double: z_i or w_i within 64 u of
// its terms, carried through the inverse, counts as zero, and a basis whose
// pivot falls below 64 u of the largest as singular.
#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace touchdown::analysis {

inline constexpr int kLcpMaxSize = 8;

enum class LcpStatus {
  kNone,      // no solution exists
  kUnique,    // one
  kSeveral,   // isolated from each other, as far as they are basic
  kContinuum  // whole segments or rays of solutions; the basic ones are listed
};

// none, unique, several, continuum.
std::string_view Name(LcpStatus status);

struct LcpSolution {
  std::vector<double> z;
  std::vector<double> w;
  // |min(z, w)|_2 / |q|_2 (undivided where q = 0).
  double residual = 0.0;
  // True where a nonsingular complementary basis gives it; false for the corner
  // of a continuum that belongs to singular bases alone.
  bool basic = true;
};

struct LcpResult {
  LcpStatus status = LcpStatus::kNone;
  std::vector<LcpSolution> solutions;  // distinct; basic ones first
  int n_basic = 0;
  int n_singular_bases = 0;
};

// `m` is row by row, `q` has n entries, 1 <= n <= 8, m.size() = n^2, all
// finite; otherwise std::invalid_argument. Cost grows as 2^n n^3.
LcpResult SolveLcp(std::span<const double> m, std::span<const double> q);

}  // namespace touchdown::analysis
