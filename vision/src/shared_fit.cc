#include "shared_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "robust.h"

namespace touchdown::vision {
namespace {

constexpr std::size_t kLeastSharing = 3;  // frames

struct FrameStep {
  const SharedTerms* terms = nullptr;
  double step = 0.0;  // of the size, by this frame alone
  double u = 0.0;
};

// What one frame says alone: blur and exposure no better known than this.
FrameStep Alone(const SharedTerms& terms) {
  constexpr double kVague = 1.0;  // px, and share
  Eigen::Matrix4d information = terms.information;
  information.diagonal().array() += 1.0 / (kVague * kVague);
  const Eigen::Matrix4d covariance =
      information.ldlt().solve(Eigen::Matrix4d::Identity());
  return {&terms, covariance.row(0).dot(terms.gradient),
          std::sqrt(covariance(0, 0))};
}

std::vector<FrameStep> Collect(std::span<const Fitted> all) {
  constexpr double kWhole = 0.98;
  std::vector<FrameStep> told;
  for (const bool strict : {true, false}) {
    told.clear();
    for (const Fitted& f : all) {
      if (!f.fit.shared || (strict && f.fit.visible < kWhole)) continue;
      told.push_back(Alone(*f.fit.shared));
    }
    if (told.size() >= kLeastSharing) break;
  }
  return told;
}

void DropFarOff(std::vector<FrameStep>& told) {
  std::vector<double> values;
  values.reserve(told.size());
  for (const FrameStep& t : told) values.push_back(t.step);
  const double centre = Median(values);
  for (double& v : values) v = std::abs(v - centre);
  constexpr double kMost = 4.0;
  const double scatter = kSigmaPerMedian * Median(std::move(values));
  std::erase_if(told, [&](const FrameStep& t) {
    return std::abs(t.step - centre) > kMost * scatter;
  });
}

}  // namespace

SharedTerms WithoutOwn(const Eigen::MatrixXd& normal,
                       const Eigen::VectorXd& gradient,
                       const std::array<int, 4>& at) {
  // The frame's own parameters with the shared ones held.
  Eigen::MatrixXd own = normal;
  Eigen::MatrixXd across = Eigen::MatrixXd::Zero(normal.rows(), 4);
  Eigen::VectorXd own_gradient = gradient;
  for (int j = 0; j < 4; ++j) {
    const int k = at[static_cast<std::size_t>(j)];
    if (k >= 0) across.col(j) = normal.col(k);
  }
  for (const int k : at) {
    if (k < 0) continue;
    own.row(k).setZero();
    own.col(k).setZero();
    own(k, k) = 1.0;
    own_gradient[k] = 0.0;
    across.row(k).setZero();
  }
  const Eigen::LDLT<Eigen::MatrixXd> factor(own);
  const Eigen::MatrixXd through = across.transpose() * factor.solve(across);
  const Eigen::Vector4d reached =
      across.transpose() * factor.solve(own_gradient);
  SharedTerms terms;
  for (int i = 0; i < 4; ++i) {
    const int row = at[static_cast<std::size_t>(i)];
    if (row < 0) continue;
    terms.gradient[i] = gradient[row] - reached[i];
    for (int j = 0; j < 4; ++j) {
      const int column = at[static_cast<std::size_t>(j)];
      if (column < 0) continue;
      terms.information(i, j) = normal(row, column) - through(i, j);
    }
  }
  return terms;
}

std::optional<SharedStep> StepTogether(std::span<const Fitted> all) {
  std::vector<FrameStep> told = Collect(all);
  DropFarOff(told);
  if (told.size() < kLeastSharing) return std::nullopt;
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
  for (const FrameStep& t : told) {
    information += t.terms->information;
    gradient += t.terms->gradient;
  }
  // What is not told has no row: it stays as it is.
  Eigen::Array4d known = Eigen::Array4d::Ones();
  for (int k = 0; k < 4; ++k) {
    if (information(k, k) > 0.0) continue;
    known[k] = 0.0;
    information(k, k) = 1.0;
  }
  const Eigen::LDLT<Eigen::Matrix4d> factor(information);
  if (factor.info() != Eigen::Success || !factor.isPositive()) {
    return std::nullopt;
  }
  SharedStep step;
  step.step = known * factor.solve(gradient).array();
  const Eigen::Matrix4d covariance = factor.solve(Eigen::Matrix4d::Identity());
  double chi2 = 0.0;
  for (const FrameStep& t : told) {
    const double z = (t.step - step.step[0]) / t.u;
    chi2 += z * z;
  }
  const double widen =
      std::sqrt(std::max(1.0, chi2 / static_cast<double>(told.size() - 1)));
  step.u = widen * known * covariance.diagonal().array().max(0.0).sqrt();
  if (!step.step.allFinite() || !step.u.allFinite()) return std::nullopt;
  return step;
}

}  // namespace touchdown::vision
