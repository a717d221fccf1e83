// The directions of a joint step that pixels tell little of, for T can follow
// them: each parameter that the frames share, and a common shift or turn of all
// poses along the body's axes. Conjugate gradients find them last; a coarse
// space solves them at once (normal_equations.h).
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <cstddef>
#include <memory>
#include <vector>

#include "layers/unknowns.h"

namespace touchdown::vision::layers {

// The shared parameters that a T which is a spline leaves free, then x, y,
// turn.
inline constexpr int kDirections = static_cast<int>(kQuadratic + kPose);
using ByDirection = Eigen::Matrix<float, Eigen::Dynamic, kDirections>;

// T's own block of the normal equations, factored.
using PictureFactor = Eigen::SimplicialLLT<Eigen::SparseMatrix<float>>;

// W of a T that is a spline: each direction with the T that costs least of what
// pixels say. It holds for other poses and pictures of the same clip: one from
// the begin of a fit takes up to a third more products than one of each step.
struct CoarseSpace {
  // Of the poses' directions, by frame: columns.
  std::vector<Eigen::Matrix3d> axes;
  ByDirection picture;  // T's part: a row a cell
  std::shared_ptr<const PictureFactor> factor;
  // W' A W without what is known beforehand
  Eigen::Matrix<double, kDirections, kDirections> stiffness;

  bool empty() const { return axes.empty(); }
  // W' x
  Eigen::VectorXd Restrict(const Unknowns& x) const;
  // x += W amounts
  void Prolong(const Eigen::VectorXd& amounts, Unknowns& x) const;
};

}  // namespace touchdown::vision::layers
