#include "layers/coarse_space.h"

namespace touchdown::vision::layers {

Eigen::VectorXd CoarseSpace::Restrict(const Unknowns& x) const {
  const Eigen::Map<const Eigen::VectorXf> cells(x.picture.data(),
                                                picture.rows());
  Eigen::VectorXd along = (picture.transpose() * cells).cast<double>();
  along.head<kQuadratic>() +=
      Eigen::Map<const Eigen::VectorXd>(x.shared.data(), kQuadratic);
  for (std::size_t t = 0; t < axes.size(); ++t) {
    along.tail<kPose>() +=
        axes[t].transpose() *
        Eigen::Map<const Eigen::Vector3d>(&x.poses[kPose * t]);
  }
  return along;
}

void CoarseSpace::Prolong(const Eigen::VectorXd& amounts, Unknowns& x) const {
  Eigen::Map<Eigen::VectorXf>(x.picture.data(), picture.rows()) +=
      picture * amounts.cast<float>();
  Eigen::Map<Eigen::VectorXd>(x.shared.data(), kQuadratic) +=
      amounts.head<kQuadratic>();
  for (std::size_t t = 0; t < axes.size(); ++t) {
    Eigen::Map<Eigen::Vector3d>(&x.poses[kPose * t]) +=
        axes[t] * amounts.tail<kPose>();
  }
}

}  // namespace touchdown::vision::layers
