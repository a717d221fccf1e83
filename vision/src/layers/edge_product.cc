#include "layers/edge_product.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "touchdown/core/normal.h"

namespace touchdown::vision::layers {
namespace {

// 1 / (2 pi), of the normal density of two variables.
constexpr float kPerTwoPi = static_cast<float>(0.5 * std::numbers::inv_pi);
// Parallel edges are taken as a little askew: quotients stay finite.
constexpr float kMostRho = 0.999999F;
// Beyond it edges are nearly parallel, and the integrand is too steep.
constexpr float kNearlyParallel = 0.998F;

// Phi2(z1, z2; rho) - Phi(z1) Phi(z2) of nearly parallel edges: as if the
// second distance were the first and a little noise, w = sqrt(1 - rho^2), more:
//   Phi(min) - phi w (phi(k) - k Phi(-k)),  k = |z1 - z2| / w.
float NearlyParallel(double z1, double z2, double rho) {
  const double w = std::sqrt(1.0 - rho * rho);
  const double k = std::abs(z1 - z2) / w;
  const double blunt = core::NormalDensity(0.5 * (z1 + z2)) * w *
                       (core::NormalDensity(k) - k * core::NormalCdf(-k));
  return static_cast<float>(core::NormalCdf(std::min(z1, z2)) - blunt -
                            core::NormalCdf(z1) * core::NormalCdf(z2));
}

}  // namespace

// The curvature over the step falls from 1 to -1 as z grows.
EdgeTable::EdgeTable(double blur) {
  // Blurs from the edge, as from the body's own (kFar in shape_cover.cc).
  constexpr double kFarthest = 3.5;
  const double h = 1.0 / blur;
  const auto step = [h](double z) {
    return core::NormalCdf(z + h) - core::NormalCdf(z - h);
  };
  const auto ratio = [h, &step](double z) {
    return (core::NormalCdf(z + h) + core::NormalCdf(z - h) -
            2.0 * core::NormalCdf(z)) /
           std::max(step(z), 1e-9);
  };
  // Inverted by linear interpolation between so many z: within 5e-5.
  constexpr std::size_t kSteps = 512;
  std::size_t left = kCells + 1;  // cells from 0 on that are still empty
  const auto fill_down_to = [&](double seen, double z, double per_ratio) {
    for (; left > 0; --left) {
      const double wanted = 2.0 * static_cast<double>(left - 1) / kCells - 1.0;
      if (wanted < seen) break;
      const double at = z + per_ratio * (wanted - seen);
      z_[left - 1] = static_cast<float>(at);
      share_[left - 1] = static_cast<float>(step(at));
    }
  };
  double before = ratio(-kFarthest);
  fill_down_to(before, -kFarthest, 0.0);
  // Between two steps, in blurs.
  constexpr double kApart = 2.0 * kFarthest / kSteps;
  for (std::size_t n = 1; n <= kSteps && left > 0; ++n) {
    const double z = kApart * static_cast<double>(n) - kFarthest;
    const double here = ratio(z);
    fill_down_to(here, z, kApart / (here - before));
    before = here;
  }
  constexpr double kNone = -2.0;  // below every ratio: fills what is left
  fill_down_to(kNone, kFarthest, 0.0);
}

EdgeTable::Place EdgeTable::Look(float curvature) const {
  const float at =
      std::clamp(0.5F * (curvature + 1.0F) * static_cast<float>(kCells), 0.0F,
                 static_cast<float>(kCells) - 1e-3F);
  const auto cell = static_cast<std::size_t>(at);
  const float share = at - static_cast<float>(cell);
  return {z_[cell] + share * (z_[cell + 1] - z_[cell]),
          share_[cell] + share * (share_[cell + 1] - share_[cell])};
}

StillEdges::StillEdges(const float* still, std::int32_t width, double blur,
                       double least_dn)
    : still_(still),
      width_(width),
      blur_(blur),
      least_dn_(static_cast<float>(least_dn)) {}

StillEdge StillEdges::FindEdge(std::int32_t pixel) {
  StillEdge edge;
  const float* const here = still_ + pixel;
  const float step_x = here[1] - here[-1];
  const float step_y = here[width_] - here[-width_];
  const bool upright = std::abs(step_y) >= std::abs(step_x);
  const float step = upright ? step_y : step_x;
  if (std::abs(step) < least_dn_) return edge;
  const float bend = upright ? here[width_] + here[-width_] - 2.0F * here[0]
                             : here[1] + here[-1] - 2.0F * here[0];
  const float length = std::hypot(step_x, step_y);
  edge.normal_x = step_x / length;
  edge.normal_y = step_y / length;
  if (!table_) table_.emplace(blur_);
  const auto [z, of] = table_->Look(bend / std::abs(step));
  edge.z = z;
  // Far from an edge, what little steps is as likely something else.
  constexpr float kLeastShare = 0.02F;
  if (of < kLeastShare) return {};
  edge.contrast = std::abs(step) / of;
  return edge;
}

float EdgeProduct(float z1, float z2, float rho) {
  // Gauss's, of six points, on 0 to 1.
  static constexpr std::array<float, 6> kNodes = {0.033765243F, 0.169395307F,
                                                  0.380690407F, 0.619309593F,
                                                  0.830604693F, 0.966234757F};
  // Of these nodes; their sum is 1.
  static constexpr std::array<float, 6> kWeights = {0.085662246F, 0.180380787F,
                                                    0.233956967F, 0.233956967F,
                                                    0.180380787F, 0.085662246F};
  if (rho < 0.0F) return -EdgeProduct(z1, -z2, -rho);
  if (rho > kNearlyParallel) {
    return NearlyParallel(static_cast<double>(z1), static_cast<double>(z2),
                          static_cast<double>(std::min(rho, kMostRho)));
  }
  const float end = std::asin(rho);
  const float squares = z1 * z1 + z2 * z2;
  float sum = 0.0F;
  for (std::size_t i = 0; i < kNodes.size(); ++i) {
    const float sine = std::sin(kNodes[i] * end);
    const float cosine2 = 1.0F - sine * sine;
    sum += kWeights[i] *
           std::exp(-0.5F * (squares - 2.0F * z1 * z2 * sine) / cosine2);
  }
  return kPerTwoPi * end * sum;
}

float EdgeProductSlope(float z1, float z2, float rho) {
  const double r = std::clamp(rho, -kMostRho, kMostRho);
  const double given = (static_cast<double>(z2) - r * static_cast<double>(z1)) /
                       std::sqrt(1.0 - r * r);
  return static_cast<float>(
      core::NormalDensity(static_cast<double>(z1)) *
      (core::NormalCdf(given) - core::NormalCdf(static_cast<double>(z2))));
}

}  // namespace touchdown::vision::layers
