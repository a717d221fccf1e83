#include "outline/shared_fit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "numbers/robust.h"

namespace touchdown::vision {
namespace {

// Frames: with fewer there is no scatter to widen the u by.
constexpr std::size_t kMinSharing = 3;

// What one frame says of the shared parameters.
struct FrameStep {
  const SharedTerms* terms = nullptr;
  double step = 0.0;  // of the size, by this frame alone
  double u = 0.0;
};

// The step of the size by one frame alone. Blur and shutter, which one frame
// may not tell, get a weak prior.
FrameStep Alone(const SharedTerms& terms) {
  // px of blur, and share of the frame interval: the prior's u, far wider than
  // what all frames tell.
  constexpr double kVagueU = 1.0;
  Eigen::Matrix4d information = terms.information;
  information.diagonal().array() += 1.0 / (kVagueU * kVagueU);
  const Eigen::Matrix4d covariance = SymmetricFactor(information).Inverse();
  return {&terms, covariance.row(0).dot(terms.gradient),
          std::sqrt(covariance(0, 0))};
}

// Frames that show the whole outline; all of them where those are too few.
std::vector<FrameStep> Collect(std::span<const Fitted> all) {
  std::vector<FrameStep> told;
  for (const bool strict : {true, false}) {
    told.clear();
    for (const Fitted& f : all) {
      if (!f.fit.shared || (strict && f.fit.visible < kWhollySeen)) continue;
      told.push_back(Alone(*f.fit.shared));
    }
    if (told.size() >= kMinSharing) break;
  }
  return told;
}

// Rejects frames whose own step lies far off the median.
void DropFarOff(std::vector<FrameStep>& told) {
  std::vector<double> values;
  values.reserve(told.size());
  for (const FrameStep& t : told) values.push_back(t.step);
  const double centre = Median(values);
  for (double& v : values) v = std::abs(v - centre);
  // In units of the robust scatter. Not studied.
  constexpr double kMaxScatters = 4.0;
  const double scatter = kSigmaPerMedian * Median(std::move(values));
  std::erase_if(told, [&](const FrameStep& t) {
    return std::abs(t.step - centre) > kMaxScatters * scatter;
  });
}

}  // namespace

// Schur complement: the shared block less what the frame's own parameters
// explain of it, A_ss - A_so A_oo^-1 A_os, and the gradient alike.
SharedTerms WithoutOwn(const NormalMatrix& normal, const NormalVector& gradient,
                       const std::array<int, 4>& at) {
  // The frame's own parameters with the shared ones held.
  NormalMatrix own = normal;
  NormalMatrix across = NormalMatrix::Zero(normal.rows(), 4);
  NormalVector own_gradient = gradient;
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
  const SymmetricFactor factor(own);
  const NormalMatrix through = across.transpose() * factor.SolveColumns(across);
  const Eigen::Vector4d reached =
      across.transpose() * factor.Solve(own_gradient);
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

// The frames' reduced equations add up; their sum is solved for the joint step.
std::optional<SharedStep> StepTogether(std::span<const Fitted> all) {
  std::vector<FrameStep> told = Collect(all);
  DropFarOff(told);
  if (told.size() < kMinSharing) return std::nullopt;
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
  const SymmetricFactor factor(information);
  if (!factor.succeeded() || !factor.is_positive()) {
    return std::nullopt;
  }
  SharedStep step;
  step.step = known * factor.Solve(gradient).array();
  const Eigen::Matrix4d covariance = factor.Inverse();
  // Scatter of the frames' own steps about the joint one widens its u.
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
