#include "kinks.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

namespace touchdown::vision {
namespace {

struct Sides {
  double jump = 0.0;
  double u = 0.0;
  double bic = 0.0;
  double chi2 = 0.0;
  double meet_s = 0.0;
  bool ok = false;
};

enum class Curvature { kKnown, kShared, kOwn };

// Left and right of the middle: value = h + v t + c t^2 with c known (that of
// free flight), shared, or one of each side.
Sides FitSides(std::span<const PlaneSample> left,
               std::span<const PlaneSample> right, Curvature curvature,
               double gravity, double PlaneSample::*value,
               double PlaneSample::*u) {
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
  const int n = curvature == Curvature::kOwn      ? 6
                : curvature == Curvature::kShared ? 5
                                                  : 4;
  const int count = static_cast<int>(left.size() + right.size());
  Sides sides;
  if (count <= n) return sides;
  const double middle = 0.5 * (left.back().time_s + right.front().time_s);
  const double unit = right.back().time_s - left.front().time_s;
  const double origin = left.back().*value;
  Matrix a = Matrix::Zero(n, n);
  Vector b = Vector::Zero(n);
  const auto row_of = [&](const PlaneSample& s, bool is_right) {
    Vector row = Vector::Zero(n);
    const double t = (s.time_s - middle) / unit;
    const int at = is_right ? 2 : 0;
    row[at] = 1.0;
    row[at + 1] = t;
    if (n > 4) row[n == 6 && is_right ? 5 : 4] = t * t;
    return row;
  };
  const auto measured = [&](const PlaneSample& s) {
    const double t = s.time_s - middle;
    return s.*value - origin + (n == 4 ? 0.5 * gravity * t * t : 0.0);
  };
  const auto add = [&](std::span<const PlaneSample> side, bool is_right) {
    for (const PlaneSample& s : side) {
      const Vector row = row_of(s, is_right);
      const double w = 1.0 / (s.*u * s.*u);
      a.noalias() += w * row * row.transpose();
      b.noalias() += w * measured(s) * row;
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
      const double r = (measured(s) - row_of(s, is_right).dot(x)) / (s.*u);
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
  sides.chi2 = chi2;
  sides.bic = chi2 + n * std::log(static_cast<double>(count));
  // Lines through the middle meet where the heights agree.
  const double dv = x[3] - x[1];
  sides.meet_s = middle + unit * (dv != 0.0 ? (x[0] - x[2]) / dv : 0.0);
  sides.ok = std::isfinite(sides.u) && sides.u > 0.0;
  return sides;
}

// Sum of squared residuals, in sigmas, of one straight line with `gravity`
// added: of rest and sliding (0) or of one flight.
double WithoutBlow(std::span<const PlaneSample> left,
                   std::span<const PlaneSample> right, double gravity,
                   double PlaneSample::*value, double PlaneSample::*u) {
  const double middle = 0.5 * (left.back().time_s + right.front().time_s);
  const double unit = right.back().time_s - left.front().time_s;
  const double origin = left.back().*value;
  double sw = 0, st = 0, sh = 0, stt = 0, sth = 0, shh = 0;
  for (const auto side : {left, right}) {
    for (const PlaneSample& s : side) {
      const double w = 1.0 / (s.*u * s.*u);
      const double seconds = s.time_s - middle;
      const double t = seconds / unit;
      const double h = s.*value - origin + 0.5 * gravity * seconds * seconds;
      sw += w;
      st += w * t;
      sh += w * h;
      stt += w * t * t;
      sth += w * t * h;
      shh += w * h * h;
    }
  }
  const double tt = stt - st * st / sw;
  const double th = sth - st * sh / sw;
  return shh - sh * sh / sw - (tt > 0.0 ? th * th / tt : 0.0);
}

}  // namespace

std::vector<Kink> FindKinks(std::span<const PlaneSample> samples,
                            const KinkOptions& options) {
  constexpr std::size_t kWindows[] = {3, 4, 6, 10, 16, 28};
  std::vector<Kink> candidates;
  std::vector<std::size_t> reach;
  const auto look = [&](std::span<const PlaneSample> left,
                        std::span<const PlaneSample> right, std::size_t k,
                        double PlaneSample::*value, double PlaneSample::*u) {
    const double gravity = options.gravity_px_per_s2.value_or(0.0);
    Sides sides = FitSides(left, right, Curvature::kShared, gravity, value, u);
    const auto better = [&](Curvature curvature) {
      const Sides other = FitSides(left, right, curvature, gravity, value, u);
      if (other.ok && (!sides.ok || other.bic < sides.bic)) sides = other;
    };
    if (left.size() >= 4 && right.size() >= 4) better(Curvature::kOwn);
    double most = std::numeric_limits<double>::infinity();
    if (options.gravity_px_per_s2) {
      // Gravity is no guess: free curvature must explain clearly more.
      constexpr double kClearly = 6.0;  // of BIC: odds of e^3
      const Sides known =
          FitSides(left, right, Curvature::kKnown, gravity, value, u);
      if (known.ok && (!sides.ok || known.bic < sides.bic + kClearly)) {
        sides = known;
        // Rest looks like many small bounces, and one flight like none: the
        // blow must explain what neither does.
        const double without =
            std::min(WithoutBlow(left, right, 0.0, value, u),
                     WithoutBlow(left, right, gravity, value, u));
        most = std::sqrt(std::max(0.0, without - sides.chi2));
      }
    }
    if (!sides.ok || sides.jump <= 0.0) return;
    const double significance = std::min(most, sides.jump / sides.u);
    const double span_s = right.back().time_s - left.front().time_s;
    if (significance < options.least_significance) return;
    if (0.25 * sides.jump * span_s < options.least_effect_px) return;
    Kink kink;
    kink.after = k;
    kink.jump = sides.jump;
    kink.significance = significance;
    kink.of_gap = value == &PlaneSample::gap_px;
    kink.time_s =
        std::clamp(sides.meet_s, left.front().time_s, right.back().time_s);
    candidates.push_back(kink);
    reach.push_back(
        std::max<std::size_t>(2, std::min(left.size(), right.size()) / 2));
  };
  const bool turns = !samples.empty() && samples.front().u_face_rad > 0.0;
  for (const std::size_t window : kWindows) {
    for (std::size_t k = 1; k + 2 < samples.size(); ++k) {
      // Left: [.., k], right: [k + 1, ..]; shorter near the ends.
      const std::size_t n_left = std::min(window, k + 1);
      const std::size_t n_right = std::min(window, samples.size() - k - 1);
      if (n_left < 2 || n_right < 2 || n_left + n_right < 6) continue;
      // A window that was cut at both ends was tried already.
      if (n_left < window && n_right < window) continue;
      const auto left = samples.subspan(k + 1 - n_left, n_left);
      const auto right = samples.subspan(k + 1, n_right);
      look(left, right, k, &PlaneSample::height_px, &PlaneSample::u_height_px);
      // A block's corner may rebound while its centre still comes down.
      if (turns) {
        look(left, right, k, &PlaneSample::gap_px, &PlaneSample::u_gap_px);
      }
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
