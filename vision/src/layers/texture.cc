#include "layers/texture.h"

#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

namespace touchdown::vision::layers {

namespace {

// Over the lag `lag_px` along a row: the mean of cos(lag k) / (rate^2 +
// lambda)^2 over all waves k of the grid, lambda being the Laplacian's value.
double CovarianceOfUnit(double rate, double lag_px) {
  constexpr int kWaves = 32;  // along each axis, of 0 to pi
  double sum = 0.0;
  for (int j = 0; j < kWaves; ++j) {
    for (int i = 0; i < kWaves; ++i) {
      const double kx = std::numbers::pi * (i + 0.5) / kWaves;
      const double ky = std::numbers::pi * (j + 0.5) / kWaves;
      const double stiff =
          rate * rate + 4.0 - 2.0 * std::cos(kx) - 2.0 * std::cos(ky);
      sum += std::cos(lag_px * kx) / (stiff * stiff);
    }
  }
  return sum / (kWaves * kWaves);
}

// Between textures that are smooth over 10 px, which the waves above tell
// apart, and white ones.
constexpr double kLeastRate = 0.1;
constexpr double kMostRate = 10.0;

// The rate at which the autocorrelation over `lag_px` is `correlation`.
double RateOf(double correlation, double lag_px) {
  double low = std::log(kLeastRate);
  double high = std::log(kMostRate);
  constexpr int kHalvings = 12;  // to 0.1 % of the rate
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    const double rate = std::exp(middle);
    const double there = CovarianceOfUnit(rate, lag_px) / UnitVariance(rate);
    (there > correlation ? low : high) = middle;
  }
  return std::exp(0.5 * (low + high));
}

// Gram and Schmidt's process, each column twice: then orthogonal to rounding
// (L. Giraud, J. Langou, M. Rozloznik, Comput. Math. Appl. 50, 2005). A column
// that those before it span becomes zero. Eigen's factorisations of a matrix
// this tall take the compiler seconds.
Eigen::MatrixXd MakeOrthonormal(Eigen::MatrixXd columns) {
  constexpr double kSpanned = 1e-9;  // of its length: rounding is 1e-16
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const double length = columns.col(k).norm();
    const auto before = columns.leftCols(k);
    for (int pass = 0; pass < 2; ++pass) {
      const Eigen::VectorXd along = before.transpose() * columns.col(k);
      columns.col(k) -= before * along;
    }
    const double left = columns.col(k).norm();
    columns.col(k) *= left > kSpanned * length ? 1.0 / left : 0.0;
  }
  return columns;
}

}  // namespace

double UnitVariance(double rate) { return CovarianceOfUnit(rate, 0.0); }

PicturePrior::PicturePrior(const PictureGrid& grid, const Texture& texture)
    : slopes_(static_cast<Eigen::Index>(grid.size()),
              static_cast<Eigen::Index>(grid.size())),
      precision_(
          static_cast<float>(UnitVariance(texture.rate) /
                             (texture.deviation_dn * texture.deviation_dn))) {
  const double half_x = 0.5 * grid.columns();
  const double half_y = 0.5 * grid.rows();
  Eigen::MatrixXd terms(grid.size(), kTerms);
  std::vector<Eigen::Triplet<float>> slopes;
  const auto join = [&](Eigen::Index a, Eigen::Index b) {
    slopes.emplace_back(a, a, 1.0F);
    slopes.emplace_back(b, b, 1.0F);
    slopes.emplace_back(a, b, -1.0F);
    slopes.emplace_back(b, a, -1.0F);
  };
  Eigen::Index cell = 0;
  for (std::int32_t j = 0; j < grid.rows(); ++j) {
    for (std::int32_t i = 0; i < grid.columns(); ++i, ++cell) {
      const double x = static_cast<double>(grid.x_of(i)) / half_x;
      const double y = static_cast<double>(grid.y_of(j)) / half_y;
      terms.row(cell) << 1.0, x, y, x * x, x * y, y * y;
      slopes.emplace_back(cell, cell,
                          static_cast<float>(texture.rate * texture.rate));
      if (i > 0) join(cell, cell - 1);
      if (j > 0) join(cell, cell - grid.columns());
    }
  }
  slopes_.setFromTriplets(slopes.begin(), slopes.end());
  basis_ = MakeOrthonormal(std::move(terms));
}

void PicturePrior::RemoveQuadratic(Eigen::VectorXf& x) const {
  const Eigen::VectorXd all = x.cast<double>();
  x = (all - basis_ * (basis_.transpose() * all)).cast<float>();
}

void PicturePrior::Multiply(const float* from, float* to) const {
  Eigen::VectorXf x = Eigen::Map<const Eigen::VectorXf>(from, basis_.rows());
  RemoveQuadratic(x);
  x = precision_ * (slopes_ * (slopes_ * x).eval());
  RemoveQuadratic(x);
  Eigen::Map<Eigen::VectorXf>(to, basis_.rows()) = x;
}

Eigen::SparseMatrix<float> PicturePrior::MakePrecision() const {
  return precision_ * Eigen::SparseMatrix<float>(slopes_ * slopes_);
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

Texture MeasureTexture(const Layers& layers, const std::vector<float>& weight) {
  // Inside of the half sides: nearer, an error of the outline looks like
  // texture.
  constexpr double kBlurs = 1.5;
  constexpr double kLeastHalf = 0.3;  // of a thin body's half side
  const Shape& shape = layers.shape;
  const auto inner = [&](double half) {
    return std::max(half - kBlurs * layers.blur, kLeastHalf * half);
  };
  const double half_x = inner(shape.half_long);
  const double half_y = inner(shape.half_short);
  std::vector<std::size_t> inside;
  double level = 0.0;
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
    level += static_cast<double>(layers.picture[c]);
    inside.push_back(c);
  }
  // Fewer leave no scatter to measure.
  constexpr std::size_t kLeastCells = 12;
  if (inside.size() < kLeastCells) {
    return layers.texture;
  }
  level /= static_cast<double>(inside.size());
  const double variance = layers.noise_dn * layers.noise_dn;
  const double texture2 =
      layers.texture.deviation_dn * layers.texture.deviation_dn;
  // The posterior's own variance is added: expectation maximisation.
  const auto own = [&](std::size_t c) {
    return 1.0 / (static_cast<double>(weight[c]) / variance +
                  1.0 / std::max(texture2, 1e-12));
  };
  std::vector<double> off(weight.size(),
                          std::numeric_limits<double>::quiet_NaN());
  double sum = 0.0;
  for (const std::size_t c : inside) {
    off[c] = static_cast<double>(layers.picture[c]) - level;
    sum += off[c] * off[c] + own(c);
  }
  // Of the autocorrelation: about an edge's blur, over which T is not told.
  constexpr std::int32_t kLag_px = 2;
  double apart = 0.0;
  double pairs = 0.0;
  const auto add = [&](std::size_t a, std::size_t b) {
    const double difference = off[a] - off[b];
    if (std::isnan(difference)) return;
    apart += difference * difference + own(a) + own(b);
    pairs += 1.0;
  };
  const auto columns = static_cast<std::size_t>(layers.grid.columns());
  for (const std::size_t c : inside) {
    if (c % columns + kLag_px < columns) add(c, c + kLag_px);
    if (c + kLag_px * columns < off.size()) add(c, c + kLag_px * columns);
  }
  const double mean = sum / static_cast<double>(inside.size());
  Texture texture{std::sqrt(mean), layers.texture.rate};
  if (pairs > 0.0) {
    texture.rate = RateOf(1.0 - 0.5 * apart / pairs / mean, kLag_px);
  }
  return texture;
}

}  // namespace touchdown::vision::layers
