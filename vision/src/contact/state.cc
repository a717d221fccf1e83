#include "touchdown/vision/contact/state.h"

#include <algorithm>
#include <cmath>

#include "touchdown/core/normal.h"

namespace touchdown::vision {

double DetectableGap(double gap_noise_m, double frames_per_s, double u_ground_m,
                     double gravity_mps2) {
  // Level and power 0.95, one-sided: 2 x 1.645 standard deviations. Larger
  // calls fewer gaps detectable.
  constexpr double kPowerAndLevel = 3.29;
  // Matched filter of a hop of height h, whose gap is a parabola over 2 sqrt(2
  // h / g): its energy is (16/15) f h^2 sqrt(2 h / g). Solved for h.
  const double matched = std::pow(
      kPowerAndLevel * gap_noise_m /
          std::sqrt(16.0 / 15.0 * frames_per_s * std::sqrt(2.0 / gravity_mps2)),
      0.8);
  // A shorter flight has no frame of its own beside those exposed across its
  // ends.
  constexpr double kMinHopFrames = 3.0;
  const double flight = gravity_mps2 / 8.0 * (kMinHopFrames / frames_per_s) *
                        (kMinHopFrames / frames_per_s);
  // The ground's own height is known to this at 95 %, one-sided.
  constexpr double kOneSided95 = 1.645;
  return std::hypot(std::max(matched, flight), kOneSided95 * u_ground_m);
}

StateEvidence DecideBounce(const core::Estimate& gap, double height) {
  StateEvidence evidence;
  // P(gap > height) of a normal distribution; without u it is 0 or 1.
  const double u = std::max(gap.u, 1e-300);
  evidence.p_bounce = core::NormalCdf((gap.value - height) / u);
  const core::Interval interval = core::Interval95(gap);
  if (interval.low > height) {
    evidence.label = core::MotionState::kBounce;
  } else if (interval.high < height) {
    evidence.label = core::MotionState::kStaysDown;
  }
  return evidence;
}

}  // namespace touchdown::vision
