#include "touchdown/vision/state.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchdown::vision {
namespace {

struct Local {
  double value = 0.0;
  double u = 0.0;
};

// Parabola through `samples`, read at `at`.
Local FitLocal(std::span<const PlaneSample> samples, const PlaneSample& at) {
  if (samples.size() < 4) return {at.gap_px, at.u_gap_px};
  const double unit =
      std::max(samples.back().time_s - samples.front().time_s, 1e-300);
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double chi2 = 0.0;
  const auto row_of = [&](const PlaneSample& s) {
    const double t = (s.time_s - at.time_s) / unit;
    return Eigen::Vector3d(1.0, t, t * t);
  };
  for (const PlaneSample& s : samples) {
    const double w = 1.0 / (s.u_gap_px * s.u_gap_px);
    const Eigen::Vector3d row = row_of(s);
    a.noalias() += w * row * row.transpose();
    b.noalias() += w * (s.gap_px - at.gap_px) * row;
  }
  const Eigen::LDLT<Eigen::Matrix3d> factor(a);
  const Eigen::Vector3d x = factor.solve(b);
  for (const PlaneSample& s : samples) {
    const double r = (s.gap_px - at.gap_px - row_of(s).dot(x)) / s.u_gap_px;
    chi2 += r * r;
  }
  const double widen =
      std::max(1.0, chi2 / static_cast<double>(samples.size() - 3));
  const double variance = factor.solve(Eigen::Vector3d::UnitX())[0];
  return {at.gap_px + x[0], std::sqrt(std::max(0.0, widen * variance))};
}

}  // namespace

std::optional<GreatestGap> FindGreatestGap(std::span<const PlaneSample> samples,
                                           std::span<const std::size_t> breaks,
                                           double ground_px) {
  if (samples.empty()) return std::nullopt;
  // 7 frames: the noise of the middle falls to 0.58; at 1000 frames a second
  // the parabola of free flight is followed exactly.
  constexpr std::size_t kWindow = 7;
  GreatestGap greatest;
  double best = 0.0;
  bool any = false;
  std::size_t begin = 0;
  for (std::size_t b = 0; b <= breaks.size(); ++b) {
    const std::size_t end = b < breaks.size() ? breaks[b] : samples.size();
    if (end <= begin) continue;
    const std::size_t count = end - begin;
    const std::size_t window = std::min(kWindow, count);
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t half = window / 2;
      std::size_t from = i > begin + half ? i - half : begin;
      from = std::min(from, end - window);
      const Local local = FitLocal(samples.subspan(from, window), samples[i]);
      // Among the noisy heights of a body at rest the highest is no bounce: a
      // value counts by what it surely reaches.
      const double sure = local.value - local.u;
      if (!any || sure > best) {
        any = true;
        best = sure;
        greatest.gap_px = {local.value - ground_px, local.u, std::nullopt};
        greatest.at = i;
      }
    }
    begin = end;
  }
  const std::size_t last = samples.size() - 1;
  constexpr std::size_t kLook = 3;
  if (last >= kLook && greatest.at + 1 >= samples.size()) {
    const double rise = samples[last].gap_px - samples[last - kLook].gap_px;
    // A difference of two gaps has the noise of both.
    const double u =
        std::hypot(samples[last].u_gap_px, samples[last - kLook].u_gap_px);
    greatest.still_rising = rise > 3.0 * u;
  }
  return greatest;
}

double DetectableGap(double gap_noise_m, double frames_per_s, double u_ground_m,
                     double gravity_mps2) {
  constexpr double kPowerAndLevel = 3.29;  // 2 x 1.645
  const double matched = std::pow(
      kPowerAndLevel * gap_noise_m /
          std::sqrt(16.0 / 15.0 * frames_per_s * std::sqrt(2.0 / gravity_mps2)),
      0.8);
  constexpr double kFrames = 3.0;
  const double flight =
      gravity_mps2 / 8.0 * (kFrames / frames_per_s) * (kFrames / frames_per_s);
  constexpr double kOneSided95 = 1.645;
  return std::hypot(std::max(matched, flight), kOneSided95 * u_ground_m);
}

StateEvidence DecideBounce(const core::Estimate& gap, double height) {
  StateEvidence evidence;
  const double u = std::max(gap.u, 1e-300);
  evidence.p_bounce =
      0.5 * std::erfc(-(gap.value - height) / u / std::numbers::sqrt2);
  const core::Interval interval = core::Interval95(gap);
  if (interval.low > height) {
    evidence.label = core::MotionState::kBounce;
  } else if (interval.high < height) {
    evidence.label = core::MotionState::kStaysDown;
  }
  return evidence;
}

}  // namespace touchdown::vision
