#include "numbers/symmetric_factor.h"

namespace touchdown::vision {

SymmetricFactor::SymmetricFactor(const NormalMatrix& a) : factor_(a) {}

bool SymmetricFactor::succeeded() const {
  return factor_.info() == Eigen::Success;
}

bool SymmetricFactor::is_positive() const { return factor_.isPositive(); }

double SymmetricFactor::smallest_pivot() const {
  return factor_.vectorD().minCoeff();
}

NormalVector SymmetricFactor::Solve(const NormalVector& right) const {
  return factor_.solve(right);
}

NormalMatrix SymmetricFactor::SolveColumns(const NormalMatrix& right) const {
  return factor_.solve(right);
}

NormalMatrix SymmetricFactor::Inverse() const {
  const Eigen::Index n = factor_.rows();
  return factor_.solve(NormalMatrix::Identity(n, n));
}

}  // namespace touchdown::vision
