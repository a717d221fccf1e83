#include "kinks.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace touchdown::vision {
namespace {

struct Sides {
  double jump = 0.0;
  double u = 0.0;
  double bic = 0.0;
  double meet_s = 0.0;
  bool ok = false;
};

// Left and right of `middle_s`: height = h + v t + c t^2, with one c or two.
Sides FitSides(std::span<const PlaneSample> left,
               std::span<const PlaneSample> right, bool own_curvature) {
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
  const int n = own_curvature ? 6 : 5;
  const int count = static_cast<int>(left.size() + right.size());
  Sides sides;
  if (count <= n) return sides;
  const double middle = 0.5 * (left.back().time_s + right.front().time_s);
  const double unit = right.back().time_s - left.front().time_s;
  const double origin = left.back().height_px;
  Matrix a = Matrix::Zero(n, n);
  Vector b = Vector::Zero(n);
  const auto row_of = [&](const PlaneSample& s, bool is_right) {
    Vector row = Vector::Zero(n);
    const double t = (s.time_s - middle) / unit;
    const int at = is_right ? 2 : 0;
    row[at] = 1.0;
    row[at + 1] = t;
    row[own_curvature && is_right ? 5 : 4] = t * t;
    return row;
  };
  const auto add = [&](std::span<const PlaneSample> side, bool is_right) {
    for (const PlaneSample& s : side) {
      const Vector row = row_of(s, is_right);
      const double w = 1.0 / (s.u_height_px * s.u_height_px);
      a.noalias() += w * row * row.transpose();
      b.noalias() += w * (s.height_px - origin) * row;
    }
  };
  add(left, false);
  add(right, true);
  const Eigen::LDLT<Matrix> factor(a);
  const Vector x = factor.solve(b);
  if (!x.allFinite()) return sides;
  double chi2 = 0.0;
  const auto cost = [&](std::span<const PlaneSample> side, bool is_right) {
    for (const PlaneSample& s : side) {
      const double r =
          (s.height_px - origin - row_of(s, is_right).dot(x)) / s.u_height_px;
      chi2 += r * r;
    }
  };
  cost(left, false);
  cost(right, true);
  Vector difference = Vector::Zero(n);
  difference[1] = -1.0;
  difference[3] = 1.0;
  const double widen = std::max(1.0, chi2 / (count - n));
  sides.jump = (x[3] - x[1]) / unit;
  sides.u = std::sqrt(widen * difference.dot(factor.solve(difference))) / unit;
  sides.bic = chi2 + n * std::log(static_cast<double>(count));
  // Lines through the middle meet where the heights agree.
  const double dv = x[3] - x[1];
  sides.meet_s = middle + unit * (dv != 0.0 ? (x[0] - x[2]) / dv : 0.0);
  sides.ok = std::isfinite(sides.u) && sides.u > 0.0;
  return sides;
}

}  // namespace

std::vector<Kink> FindKinks(std::span<const PlaneSample> samples,
                            const KinkOptions& options) {
  constexpr std::size_t kWindows[] = {3, 4, 6, 10, 16, 28};
  std::vector<Kink> candidates;
  std::vector<std::size_t> reach;
  for (const std::size_t window : kWindows) {
    for (std::size_t k = 2; k + 3 < samples.size() + 1; ++k) {
      // Left: [.., k], right: [k + 1, ..]; shorter near the ends.
      const std::size_t n_left = std::min(window, k + 1);
      const std::size_t n_right = std::min(window, samples.size() - k - 1);
      if (n_left < 2 || n_right < 2 || n_left + n_right < 6) continue;
      // A window that was cut at both ends was tried already.
      if (n_left < window && n_right < window) continue;
      const auto left = samples.subspan(k + 1 - n_left, n_left);
      const auto right = samples.subspan(k + 1, n_right);
      Sides sides = FitSides(left, right, false);
      if (n_left >= 4 && n_right >= 4) {
        const Sides own = FitSides(left, right, true);
        if (own.ok && (!sides.ok || own.bic < sides.bic)) sides = own;
      }
      if (!sides.ok || sides.jump <= 0.0) continue;
      const double significance = sides.jump / sides.u;
      const double span_s = right.back().time_s - left.front().time_s;
      if (significance < options.least_significance) continue;
      if (0.25 * sides.jump * span_s < options.least_effect_px) continue;
      Kink kink;
      kink.after = k;
      kink.jump = sides.jump;
      kink.significance = significance;
      kink.time_s =
          std::clamp(sides.meet_s, left.front().time_s, right.back().time_s);
      candidates.push_back(kink);
      reach.push_back(std::max<std::size_t>(2, std::min(n_left, n_right) / 2));
    }
  }
  // The most significant one speaks for its neighbourhood.
  std::vector<std::size_t> order(candidates.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return candidates[a].significance > candidates[b].significance;
  });
  std::vector<Kink> kinks;
  std::vector<std::size_t> kept_reach;
  for (const std::size_t i : order) {
    bool near = false;
    for (std::size_t j = 0; j < kinks.size() && !near; ++j) {
      const auto distance = static_cast<std::size_t>(
          std::abs(static_cast<double>(kinks[j].after) -
                   static_cast<double>(candidates[i].after)));
      near = distance <= std::max(kept_reach[j], reach[i]);
    }
    if (near) continue;
    kinks.push_back(candidates[i]);
    kept_reach.push_back(reach[i]);
  }
  std::sort(kinks.begin(), kinks.end(),
            [](const Kink& a, const Kink& b) { return a.after < b.after; });
  return kinks;
}

}  // namespace touchdown::vision
