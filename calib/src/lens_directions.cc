#include "touchdown/calib/lens_directions.h"

#include <Eigen/Eigenvalues>

namespace touchdown::calib {

LensDirections DecomposeLensCovariance(const LensCovariance& covariance) {
  const Eigen::SelfAdjointEigenSolver<LensCovariance> solver(covariance);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace touchdown::calib
