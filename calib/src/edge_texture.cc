#include "edge_texture.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "touchdown/core/normal.h"

namespace touchdown::calib {
namespace {

constexpr std::int32_t kRows = 12;  // of a strip beside the edge

// What lies beside the edge.
struct Strip {
  std::vector<std::int32_t> first_row;  // by column, the one next to the edge
  std::int32_t step = 1;                // rows from there on
  std::vector<double> level;  // by column: it may change along the edge
};

// Mean over columns within `half` of each.
std::vector<double> Running(const std::vector<double>& values,
                            std::size_t half) {
  std::vector<double> sums(values.size() + 1, 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    sums[i + 1] = sums[i] + values[i];
  }
  std::vector<double> means(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t from = i > half ? i - half : 0;
    const std::size_t to = std::min(values.size(), i + half + 1);
    means[i] = (sums[to] - sums[from]) / static_cast<double>(to - from);
  }
  return means;
}

// The strip from `reach` rows off the edge on; nothing where the picture ends.
std::optional<Strip> Look(const StillImage& image,
                          const std::vector<double>& edge_px, double reach,
                          bool below) {
  const auto first = static_cast<std::int32_t>(std::ceil(reach)) + 1;
  Strip strip;
  strip.step = below ? 1 : -1;
  strip.first_row.reserve(edge_px.size());
  std::vector<double> mean(edge_px.size(), 0.0);
  for (std::size_t x = 0; x < edge_px.size(); ++x) {
    const auto edge = static_cast<std::int32_t>(std::lround(edge_px[x]));
    strip.first_row.push_back(edge + strip.step * first);
    for (const std::int32_t end :
         {strip.first_row[x], strip.first_row[x] + strip.step * (kRows - 1)}) {
      if (end < 0 || end >= image.height_px) return std::nullopt;
    }
    for (std::int32_t k = 0; k < kRows; ++k) {
      mean[x] += PixelLevel(image, static_cast<std::int32_t>(x),
                            strip.first_row[x] + strip.step * k) /
                 kRows;
    }
  }
  // Wide enough for a fine texture to be even, and narrow for the light.
  constexpr std::size_t kHalfWidth = 16;
  strip.level = Running(mean, kHalfWidth);
  return strip;
}

// What its samples vary by about their level, at a distance of `lag` rows.
double LagCovariance(const StillImage& image, const Strip& strip,
                     std::int32_t lag) {
  double sum = 0.0;
  for (std::size_t x = 0; x < strip.level.size(); ++x) {
    std::array<double, kRows> off{};
    for (std::int32_t k = 0; k < kRows; ++k) {
      off[static_cast<std::size_t>(k)] =
          PixelLevel(image, static_cast<std::int32_t>(x),
                     strip.first_row[x] + strip.step * k) -
          strip.level[x];
    }
    for (std::int32_t k = 0; k + lag < kRows; ++k) {
      sum += off[static_cast<std::size_t>(k)] *
             off[static_cast<std::size_t>(k + lag)];
    }
  }
  // Over all rows, not over the pairs: that is some field's covariance, which
  // that of few pairs need not be.
  return sum / (static_cast<double>(strip.level.size()) * kRows);
}

}  // namespace

std::optional<EdgeTexture> LearnTexture(const StillImage& image,
                                        const std::vector<double>& edge_px,
                                        double reach_px) {
  const auto above = Look(image, edge_px, reach_px, false);
  const auto below = Look(image, edge_px, reach_px, true);
  if (!above || !below) return std::nullopt;
  const double above_dn2 = LagCovariance(image, *above, 0);
  const double below_dn2 = LagCovariance(image, *below, 0);
  EdgeTexture texture;
  texture.below = below_dn2 > above_dn2;
  const Strip& rough = texture.below ? *below : *above;
  // Ratio of the variances beyond which the rougher side counts as textured.
  // Larger leaves faint texture in the noise; smaller takes noise for texture.
  // Not studied.
  constexpr double kMinVarianceRatio = 2.0;
  // DN^2: a synthetic picture has no noise, and a variance of 0 no inverse.
  constexpr double kMinVariance_dn2 = 1e-4;
  texture.variance_dn2 =
      std::max(std::min(below_dn2, above_dn2), kMinVariance_dn2);
  const double rough_dn2 = std::max(below_dn2, above_dn2);
  if (rough_dn2 < kMinVarianceRatio * texture.variance_dn2) return std::nullopt;
  texture.covariance_dn2.push_back(rough_dn2 - texture.variance_dn2);
  for (std::int32_t lag = 1; lag < kRows; ++lag) {
    texture.covariance_dn2.push_back(LagCovariance(image, rough, lag));
  }
  texture.ground_dn = rough.level;
  return texture;
}

EdgePoint TexturedEdge(const StillImage& image, const EdgeTexture& texture,
                       std::int32_t x, double y0, double blur_px) {
  EdgePoint edge{static_cast<double>(x), y0, 0.0};
  // In units of blur_px (and 2 px): the edge's tail has ended there.
  constexpr double kReachBlurs = 3.0;
  const double reach = kReachBlurs * blur_px + 2.0;
  const double side = texture.below ? 1.0 : -1.0;
  const double ground = texture.ground_dn[static_cast<std::size_t>(x)];
  // A bound: the loop ends at the limit below. Not studied.
  constexpr int kMaxIterations = 8;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const auto from = static_cast<std::int32_t>(std::ceil(edge.y - reach));
    const auto to = static_cast<std::int32_t>(std::floor(edge.y + reach));
    if (from < 0 || to >= image.height_px) return {edge.x, edge.y, 0.0};
    const Eigen::Index n = to - from + 1;
    Eigen::VectorXd cover(n);
    Eigen::VectorXd slope(n);
    Eigen::VectorXd value(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double y = static_cast<double>(from + i);
      const double z = side * (y - edge.y) / blur_px;
      cover[i] = core::NormalCdf(z);
      slope[i] = -side * std::exp(-0.5 * z * z) /
                 (blur_px * std::sqrt(2.0 * std::numbers::pi));
      value[i] = PixelLevel(image, x, from + static_cast<std::int32_t>(i));
    }
    Eigen::MatrixXd covariance =
        texture.variance_dn2 * Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) {
        const auto lag = static_cast<std::size_t>(std::abs(i - j));
        if (lag >= texture.covariance_dn2.size()) continue;
        covariance(i, j) += texture.covariance_dn2[lag] * cover[i] * cover[j];
      }
    }
    const Eigen::LDLT<Eigen::MatrixXd> factor(covariance);
    if (!factor.isPositive()) return {edge.x, edge.y, 0.0};
    // v - g F = a (1 - F), then the step in y at that a.
    const Eigen::VectorXd open = 1.0 - cover.array();
    const Eigen::VectorXd by_level = factor.solve(open);
    const double a = by_level.dot(value - ground * cover) / by_level.dot(open);
    const Eigen::VectorXd shift = (ground - a) * slope;
    const Eigen::VectorXd by_shift = factor.solve(shift);
    const Eigen::VectorXd residual = value - ground * cover - a * open;
    // Of the two normal equations, a and y, the second unknown.
    const double both = open.dot(by_shift);
    const double level = open.dot(by_level);
    const double step =
        (level * by_shift.dot(residual) - both * by_level.dot(residual)) /
        (level * shift.dot(by_shift) - both * both);
    if (!std::isfinite(step)) return {edge.x, edge.y, 0.0};
    edge.strength = side * (ground - a);
    edge.y += std::clamp(step, -1.0, 1.0);
    if (std::abs(edge.y - y0) > reach) return {edge.x, edge.y, 0.0};
    // px of the last step, far below an edge point's u.
    constexpr double kSettled_px = 1e-4;
    if (std::abs(step) < kSettled_px) break;
  }
  return edge;
}

}  // namespace touchdown::calib
