#include "touchdown/vision/contact/state.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchdown::vision {

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
