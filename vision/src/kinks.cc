#include "kinks.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

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

// What a fit of either side needs: a sample's time from the middle over the
// whole span, its value from the last one on the left, its weight.
struct Point {
  double t = 0.0;
  double h = 0.0;
  double w = 0.0;
};

// Weighted sums of one side: of t^k, and of h t^k.
struct Moments {
  std::array<double, 5> t{};
  std::array<double, 3> h{};
};

// The samples around one instant.
struct Around {
  std::vector<Point> points;  // left, then right
  std::size_t left = 0;       // so many
  std::array<Moments, 2> sides;
  double middle_s = 0.0;
  double unit_s = 1.0;

  void Take(std::span<const PlaneSample> before,
            std::span<const PlaneSample> after, double PlaneSample::*value,
            double PlaneSample::*u);
};

void Around::Take(std::span<const PlaneSample> before,
                  std::span<const PlaneSample> after,
                  double PlaneSample::*value, double PlaneSample::*u) {
  middle_s = 0.5 * (before.back().time_s + after.front().time_s);
  unit_s = after.back().time_s - before.front().time_s;
  const double origin = before.back().*value;
  points.clear();
  left = before.size();
  sides = {};
  const auto add = [&](std::span<const PlaneSample> side, Moments& sums) {
    for (const PlaneSample& s : side) {
      const Point p{(s.time_s - middle_s) / unit_s, s.*value - origin,
                    1.0 / (s.*u * s.*u)};
      points.push_back(p);
      double power = p.w;
      for (std::size_t k = 0; k < sums.t.size(); ++k, power *= p.t) {
        sums.t[k] += power;
        if (k < sums.h.size()) sums.h[k] += power * p.h;
      }
    }
  };
  add(before, sides[0]);
  add(after, sides[1]);
}

// Of one side's parabola h + s t + c t^2: h = u - v c, s = p - q c, and c of
// this side alone. By elimination, without a covariance: good to rounding.
struct Slopes {
  double u, v, p, q, c;

  explicit Slopes(const Moments& m) {
    const double per = 1.0 / (m.t[0] * m.t[2] - m.t[1] * m.t[1]);
    u = (m.t[2] * m.h[0] - m.t[1] * m.h[1]) * per;
    v = (m.t[2] * m.t[2] - m.t[1] * m.t[3]) * per;
    p = (m.t[0] * m.h[1] - m.t[1] * m.h[0]) * per;
    q = (m.t[0] * m.t[3] - m.t[1] * m.t[2]) * per;
    c = Right(m) / Left(m);
  }
  double Right(const Moments& m) const {
    return m.h[2] - m.t[2] * u - m.t[3] * p;
  }
  double Left(const Moments& m) const {
    return m.t[4] - m.t[2] * v - m.t[3] * q;
  }
};

// The largest of the three: px/s. `known`: there is one with known gravity.
double LargestJump(const Around& around, bool own, bool known, double gravity) {
  const auto& [left, right] = around.sides;
  const Slopes a(left);
  const Slopes b(right);
  const auto jump = [&](double bend_a, double bend_b) {
    return (b.p - b.q * bend_b - a.p + a.q * bend_a) / around.unit_s;
  };
  const double shared =
      (a.Right(left) + b.Right(right)) / (a.Left(left) + b.Left(right));
  double largest = jump(shared, shared);
  if (own) largest = std::max(largest, jump(a.c, b.c));
  if (known) {
    const double bend = -0.5 * gravity * around.unit_s * around.unit_s;
    largest = std::max(largest, jump(bend, bend));
  }
  return largest;
}

// Left and right of the middle: value = h + v t + c t^2. Of N parameters: 4, c
// known (that of free flight); 5, c shared; 6, one of each side.
template <int N>
class SidesFit {
 public:
  SidesFit(const Around& around, double gravity);

  double jump() const { return ok_ ? (x_[3] - x_[1]) / around_.unit_s : 0.0; }
  Sides Judge() const;

 private:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  const Around& around_;
  double known_ = 0.0;  // c, taken out of the values
  bool ok_ = false;
  Eigen::LDLT<Matrix> factor_;
  Vector x_ = Vector::Zero();
};

template <int N>
SidesFit<N>::SidesFit(const Around& around, double gravity) : around_(around) {
  if (static_cast<int>(around.points.size()) <= N) return;
  if (N == 4) known_ = 0.5 * gravity * around.unit_s * around.unit_s;
  Matrix a = Matrix::Zero();
  Vector b = Vector::Zero();
  for (int side = 0; side < 2; ++side) {
    const Moments& m = around.sides[static_cast<std::size_t>(side)];
    const int at = 2 * side;
    a(at, at) = m.t[0];
    a(at, at + 1) = a(at + 1, at) = m.t[1];
    a(at + 1, at + 1) = m.t[2];
    b[at] = m.h[0] + known_ * m.t[2];
    b[at + 1] = m.h[1] + known_ * m.t[3];
    if constexpr (N > 4) {
      const int bend = N == 6 ? 4 + side : 4;
      a(at, bend) = a(bend, at) = m.t[2];
      a(at + 1, bend) = a(bend, at + 1) = m.t[3];
      a(bend, bend) += m.t[4];
      b[bend] += m.h[2];
    }
  }
  factor_.compute(a);
  x_ = factor_.solve(b);
  ok_ = x_.allFinite();
}

template <int N>
Sides SidesFit<N>::Judge() const {
  Sides sides;
  if (!ok_) return sides;
  const int count = static_cast<int>(around_.points.size());
  double chi2 = 0.0;
  for (std::size_t i = 0; i < around_.points.size(); ++i) {
    const Point& p = around_.points[i];
    const int at = i < around_.left ? 0 : 2;
    double bend = -known_;
    if constexpr (N == 5) bend = x_[4];
    if constexpr (N == 6) bend = x_[4 + at / 2];
    const double r = p.h - x_[at] - p.t * (x_[at + 1] + p.t * bend);
    chi2 += p.w * r * r;
  }
  Vector difference = Vector::Zero();
  difference[1] = -1.0;
  difference[3] = 1.0;
  const double widen = std::max(1.0, chi2 / (count - N));
  sides.jump = jump();
  sides.u = std::sqrt(widen * difference.dot(factor_.solve(difference))) /
            around_.unit_s;
  sides.chi2 = chi2;
  sides.bic = chi2 + N * std::log(static_cast<double>(count));
  // Lines through the middle meet where the heights agree.
  const double dv = x_[3] - x_[1];
  sides.meet_s = around_.middle_s +
                 around_.unit_s * (dv != 0.0 ? (x_[0] - x_[2]) / dv : 0.0);
  sides.ok = std::isfinite(sides.u) && sides.u > 0.0;
  return sides;
}

// Sum of squared residuals, in sigmas, of one straight line with `gravity`
// added: of rest and sliding (0) or of one flight.
double WithoutBlow(const Around& around, double gravity) {
  const double bend = 0.5 * gravity * around.unit_s * around.unit_s;
  double sw = 0, st = 0, sh = 0, stt = 0, sth = 0, shh = 0;
  for (const Point& p : around.points) {
    const double h = p.h + bend * p.t * p.t;
    sw += p.w;
    st += p.w * p.t;
    sh += p.w * h;
    stt += p.w * p.t * p.t;
    sth += p.w * p.t * h;
    shh += p.w * h * h;
  }
  const double tt = stt - st * st / sw;
  const double th = sth - st * sh / sw;
  return shh - sh * sh / sw - (tt > 0.0 ? th * th / tt : 0.0);
}

}  // namespace

std::vector<Kink> FindKinks(std::span<const PlaneSample> samples,
                            const KinkOptions& options) {
  constexpr std::size_t kWindows[] = {3, 4, 6, 10, 16, 28};
  // One more than the numbers of two straight lines with one curvature. Of a
  // track that has no more, one more than those of two flights in known
  // gravity.
  constexpr std::size_t kLeastInBoth = 6;
  constexpr std::size_t kLeastInAll = 5;
  const std::size_t least_in_both =
      options.gravity_px_per_s2
          ? std::clamp(samples.size(), kLeastInAll, kLeastInBoth)
          : kLeastInBoth;
  std::vector<Kink> candidates;
  std::vector<std::size_t> reach;
  Around around;
  const auto look = [&](std::span<const PlaneSample> left,
                        std::span<const PlaneSample> right, std::size_t k,
                        double PlaneSample::*value, double PlaneSample::*u) {
    const double gravity = options.gravity_px_per_s2.value_or(0.0);
    around.Take(left, right, value, u);
    const double span_s = right.back().time_s - left.front().time_s;
    const bool each = left.size() >= 4 && right.size() >= 4;
    // Mostly it is far from enough.
    constexpr double kSurely = 0.9;
    if (0.25 * span_s *
            LargestJump(around, each, options.gravity_px_per_s2.has_value(),
                        gravity) <
        kSurely * options.least_effect_px) {
      return;
    }
    const SidesFit<5> shared(around, gravity);
    std::optional<SidesFit<6>> own;
    if (each) own.emplace(around, gravity);
    std::optional<SidesFit<4>> known;
    if (options.gravity_px_per_s2) known.emplace(around, gravity);
    // None of them may jump by enough, whichever is the best.
    const double most_jump = std::max(
        {shared.jump(), own ? own->jump() : 0.0, known ? known->jump() : 0.0});
    if (!(0.25 * most_jump * span_s >= options.least_effect_px)) return;
    Sides sides = shared.Judge();
    if (own) {
      const Sides other = own->Judge();
      if (other.ok && (!sides.ok || other.bic < sides.bic)) sides = other;
    }
    double most = std::numeric_limits<double>::infinity();
    if (known) {
      // Gravity is no guess: free curvature must explain clearly more.
      constexpr double kClearly = 6.0;  // of BIC: odds of e^3
      const Sides flight = known->Judge();
      if (flight.ok && (!sides.ok || flight.bic < sides.bic + kClearly)) {
        sides = flight;
        // Rest looks like many small bounces, and one flight like none: the
        // blow must explain what neither does.
        const double without =
            std::min(WithoutBlow(around, 0.0), WithoutBlow(around, gravity));
        most = std::sqrt(std::max(0.0, without - sides.chi2));
      }
    }
    if (!sides.ok || sides.jump <= 0.0) return;
    const double significance = std::min(most, sides.jump / sides.u);
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
      if (n_left < 2 || n_right < 2 || n_left + n_right < least_in_both) {
        continue;
      }
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
