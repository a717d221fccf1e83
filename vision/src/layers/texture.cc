#include "layers/texture.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace touchdown::vision::layers {

FreePart::FreePart(const PictureGrid& grid) {
  const double half_x = 0.5 * grid.columns();
  const double half_y = 0.5 * grid.rows();
  Eigen::MatrixXd terms(grid.size(), kTerms);
  Eigen::Index cell = 0;
  for (std::int32_t j = 0; j < grid.rows(); ++j) {
    for (std::int32_t i = 0; i < grid.columns(); ++i) {
      const double x = static_cast<double>(grid.x_of(i)) / half_x;
      const double y = static_cast<double>(grid.y_of(j)) / half_y;
      terms.row(cell++) << 1.0, x, y, x * x, x * y, y * y;
    }
  }
  basis_ = terms.householderQr().householderQ() *
           Eigen::MatrixXd::Identity(terms.rows(), terms.cols());
}

void FreePart::RemoveComponent(const float* from, float* to) const {
  const Eigen::VectorXd x =
      Eigen::Map<const Eigen::VectorXf>(from, basis_.rows()).cast<double>();
  Eigen::Map<Eigen::VectorXf>(to, basis_.rows()) =
      (x - basis_ * (basis_.transpose() * x)).cast<float>();
}

// Standard deviation of what a flat body's residuals have in common, cell by
// cell of its own picture: means over the frames, less the noise of a mean.
double MeasureCommonTexture(const PictureStack& stack, const Layers& layers,
                            const std::vector<LayerPose>& poses,
                            const std::vector<FrameSamples>& frames) {
  // Coverage from which on a pixel shows the body alone.
  constexpr float kWhole = 0.97F;
  std::vector<double> sums(layers.grid.size());
  std::vector<double> counts(layers.grid.size());
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const FrameSamples& samples = frames[t];
    const double cosine = std::cos(poses[t].angle_rad);
    const double sine = std::sin(poses[t].angle_rad);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (samples.cover[i] < kWhole) continue;
      const double dx = samples.pixel[i] % stack.width - poses[t].x;
      const std::int32_t row = samples.pixel[i] / stack.width;
      const double dy = row - poses[t].y;
      const SplinePlace place = layers.grid.LocatePlace(
          static_cast<float>(cosine * dx + sine * dy + 0.5),
          static_cast<float>(cosine * dy - sine * dx + 0.5));
      const auto cell = static_cast<std::size_t>(place.first);
      sums[cell] += static_cast<double>(samples.residual[i]);
      counts[cell] += 1.0;
    }
  }
  // Frames: the mean of fewer is mostly noise.
  constexpr double kEnough = 3.0;
  const double variance = layers.noise_dn * layers.noise_dn;
  double texture2 = 0.0;
  double cells = 0.0;
  for (std::size_t c = 0; c < sums.size(); ++c) {
    if (counts[c] < kEnough) continue;
    const double mean = sums[c] / counts[c];
    texture2 += mean * mean - variance / counts[c];
    cells += 1.0;
  }
  return cells > 0.0 ? std::sqrt(std::max(texture2 / cells, 0.0)) : 0.0;
}

// How often each coefficient of T is seen: the sum of squared coverage.
std::vector<float> WeighPicture(const Layers& layers,
                                const std::vector<FrameSamples>& frames) {
  std::vector<float> weight(layers.grid.size());
  for (const FrameSamples& samples : frames) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const float w = samples.weight[i] * samples.cover[i];
      for (std::size_t k = 0; k < samples.nodes; ++k) {
        const std::size_t at = i * samples.nodes + k;
        layers.grid.Spread(w * samples.share[at], samples.place[at],
                           weight.data());
      }
    }
  }
  return weight;
}

// Empirical Bayes: the variance of T about its own quadratic, over the cells
// inside of the blurred edge, where T is not to be mistaken for the outline's
// place.
double MeasureTexture(const Layers& layers, const std::vector<float>& weight) {
  // Inside of the half sides: nearer, an error of the outline looks like
  // texture.
  constexpr double kBlurs = 1.5;
  constexpr double kLeastHalf = 0.3;  // of a thin body's half side
  using TermVector = Eigen::Matrix<double, 6, 1>;
  const Shape& shape = layers.shape;
  const auto inner = [&](double half) {
    return std::max(half - kBlurs * layers.blur, kLeastHalf * half);
  };
  const double half_x = inner(shape.half_long);
  const double half_y = inner(shape.half_short);
  std::vector<std::pair<std::size_t, TermVector>> inside;
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  TermVector right = TermVector::Zero();
  for (std::size_t c = 0; c < weight.size(); ++c) {
    const auto cell = static_cast<std::int32_t>(c);
    const double x =
        static_cast<double>(layers.grid.x_of(cell % layers.grid.columns())) /
        half_x;
    const double y =
        static_cast<double>(layers.grid.y_of(cell / layers.grid.columns())) /
        half_y;
    const bool is_inside = shape.disc
                               ? std::hypot(x, y) <= 1.0
                               : std::abs(x) <= 1.0 && std::abs(y) <= 1.0;
    if (!is_inside) continue;
    TermVector terms;
    terms << 1.0, x, y, x * x, x * y, y * y;
    normal += terms * terms.transpose();
    right += static_cast<double>(layers.picture[c]) * terms;
    inside.emplace_back(c, terms);
  }
  // Twice the six numbers of the quadratic: fewer leave no scatter to measure.
  constexpr std::size_t kLeastCells = 12;
  if (inside.size() < kLeastCells) return layers.texture_dn;
  normal.diagonal().array() += 1e-6;
  const TermVector quadratic = normal.ldlt().solve(right);
  const double variance = layers.noise_dn * layers.noise_dn;
  const double texture2 = layers.texture_dn * layers.texture_dn;
  double sum = 0.0;
  for (const auto& [c, terms] : inside) {
    const double off =
        static_cast<double>(layers.picture[c]) - quadratic.dot(terms);
    // The posterior's own variance is added: expectation maximisation.
    sum += off * off + 1.0 / (static_cast<double>(weight[c]) / variance +
                              1.0 / std::max(texture2, 1e-12));
  }
  return std::sqrt(sum / static_cast<double>(inside.size()));
}

}  // namespace touchdown::vision::layers
