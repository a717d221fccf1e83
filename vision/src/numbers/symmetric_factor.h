// Solves normal equations: a symmetric matrix of few unknowns, factored.
//
// LDL' with pivots (Golub and Van Loan, Matrix Computations, 4.4), by
// Eigen::LDLT. One type holds all sizes, without the heap: the compiler takes
// seconds for each size of its own, and for each kind of right side.
#pragma once

#include <Eigen/Cholesky>

namespace touchdown::vision {

// As many as any fit of this program has.
constexpr int kMostUnknowns = 24;
using NormalVector =
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostUnknowns, 1>;
using NormalMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0,
                                   kMostUnknowns, kMostUnknowns>;

class SymmetricFactor {
 public:
  explicit SymmetricFactor(const NormalMatrix& a);

  // False where a number is not finite, or a pivot could not be used.
  bool succeeded() const;
  // No pivot is below zero.
  bool is_positive() const;
  double smallest_pivot() const;

  NormalVector Solve(const NormalVector& right) const;
  NormalMatrix SolveColumns(const NormalMatrix& right) const;
  NormalMatrix Inverse() const;

 private:
  Eigen::LDLT<NormalMatrix> factor_;
};

}  // namespace touchdown::vision
