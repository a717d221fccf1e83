#include "app/shots/rig_reach.h"

#include <cmath>

#include "touchdown/core/units.h"

namespace touchdown::pipeline {
namespace {

using core::kDegree;

// Contact angles are 0 to 90 deg by magnitude; whole degrees are asked first,
// 45 deg for the reason of a rig that can throw none, and the ends are then
// found to kEnd_rad. A set-point is no better than 0.01 deg.
constexpr int kDegrees = 90;
constexpr double kMiddle_rad = 45.0 * kDegree;
constexpr double kEnd_rad = 0.01 * kDegree;

}  // namespace

core::Expected<core::Interval> ReachableAngles(const rig::Description& rig,
                                               rig::ContactWish wish) {
  // Says whether the rig has a setting for this angle.
  const auto can = [&](double angle_rad) {
    wish.angle_rad = angle_rad;
    return rig::FindSetting(rig, wish).has_value();
  };
  // Between an angle that can be thrown and one that cannot.
  const auto edge = [&](double good, double bad) {
    while (std::abs(good - bad) > kEnd_rad) {
      const double middle = (good + bad) / 2;
      (can(middle) ? good : bad) = middle;
    }
    return good;
  };
  // The longest run of whole degrees is looked for: a rig may reach shallow and
  // steep angles with a gap between, and the next angle is clipped to one
  // interval.
  int best_first = 0;
  int best_count = 0;
  int count = 0;
  for (int degree = 0; degree <= kDegrees; ++degree) {
    count = can(degree * kDegree) ? count + 1 : 0;
    if (count > best_count) {
      best_count = count;
      best_first = degree - count + 1;
    }
  }
  if (best_count == 0) {
    wish.angle_rad = kMiddle_rad;
    const auto refused = rig::FindSetting(rig, wish);
    return core::AbsentBecause(refused ? "no whole degree can be thrown"
                                       : refused.error().reason);
  }
  // Each end is moved outwards by bisection within its last degree.
  const int last = best_first + best_count - 1;
  core::Interval out{best_first * kDegree, last * kDegree};
  if (best_first > 0) out.low = edge(out.low, (best_first - 1) * kDegree);
  if (last < kDegrees) out.high = edge(out.high, (last + 1) * kDegree);
  return out;
}

}  // namespace touchdown::pipeline
