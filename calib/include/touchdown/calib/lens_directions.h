#ifndef TOUCHDOWN_CALIB_LENS_DIRECTIONS_H_
#define TOUCHDOWN_CALIB_LENS_DIRECTIONS_H_

#include "touchdown/calib/lens.h"

namespace touchdown::calib {

// The directions in which a lens' parameters vary independently of each other.
struct LensDirections {
  LensVector variances = LensVector::Zero();           // ascending
  LensCovariance directions = LensCovariance::Zero();  // unit columns
};

// Eigenvalues and eigenvectors of a symmetric matrix, of which the lower half
// is read. Here, so that Eigen's solver is compiled once.
LensDirections DecomposeLensCovariance(const LensCovariance& covariance);

}  // namespace touchdown::calib

#endif  // TOUCHDOWN_CALIB_LENS_DIRECTIONS_H_
