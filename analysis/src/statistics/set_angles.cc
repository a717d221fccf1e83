#include "touchdown/analysis/statistics/set_angles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "touchdown/analysis/statistics/agreement.h"
#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

// Trials at one set angle, by index.
struct Repeats {
  std::vector<std::size_t> members;
  double mean_rad = 0.0;
};

std::vector<Repeats> FindRepeats(std::span<const Observation> observations) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (observations[i].set_angle_rad) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) {
                     const Observation& x = observations[a];
                     const Observation& y = observations[b];
                     if (x.setup != y.setup) return x.setup < y.setup;
                     return *x.set_angle_rad < *y.set_angle_rad;
                   });
  std::vector<Repeats> out;
  for (std::size_t i = 0; i < order.size();) {
    const Observation& first = observations[order[i]];
    Repeats repeats;
    double sum = 0.0;
    double least = first.angle_rad;
    double greatest = first.angle_rad;
    for (; i < order.size(); ++i) {
      const Observation& o = observations[order[i]];
      if (o.setup != first.setup ||
          *o.set_angle_rad - *first.set_angle_rad > kSameAngle_rad) {
        break;
      }
      repeats.members.push_back(order[i]);
      sum += o.angle_rad;
      least = std::min(least, o.angle_rad);
      greatest = std::max(greatest, o.angle_rad);
    }
    repeats.mean_rad = sum / static_cast<double>(repeats.members.size());
    if (greatest - least > kSameAngle_rad) out.push_back(std::move(repeats));
  }
  return out;
}

}  // namespace

SetAngleUse UseSetAngles(std::span<const Observation> observations,
                         const SetAngleOptions& options) {
  core::RequireNotNegative("set_u_rad", options.set_u_rad);
  core::RequireNotNegative("worth_trials", options.worth_trials);
  SetAngleUse out;
  out.observations.assign(observations.begin(), observations.end());
  const std::vector<Repeats> all = FindRepeats(observations);
  double freedom = options.worth_trials;
  double scatter = options.worth_trials * options.set_u_rad * options.set_u_rad;
  // Of each trial's square, what the measurement's own error puts there is
  // taken off.
  for (const Repeats& repeats : all) {
    const auto n = static_cast<double>(repeats.members.size());
    freedom += n - 1.0;
    for (const std::size_t i : repeats.members) {
      const double d = observations[i].angle_rad - repeats.mean_rad;
      const double u = observations[i].u_rad;
      scatter += d * d - u * u * (n - 1.0) / n;
    }
  }
  if (all.empty() || !(freedom > 0.0)) return out;
  const double variance = std::max(scatter / freedom, 0.0);
  out.set_u_rad = std::sqrt(variance);
  for (const Repeats& repeats : all) {
    const auto n = static_cast<double>(repeats.members.size());
    for (const std::size_t i : repeats.members) {
      Observation& o = out.observations[i];
      const double total = variance + o.u_rad * o.u_rad;
      if (!(total > 0.0)) continue;
      const double k = variance / total;
      o.angle_rad = repeats.mean_rad + k * (o.angle_rad - repeats.mean_rad);
      o.u_rad =
          std::sqrt(k * o.u_rad * o.u_rad + (1.0 - k) * (1.0 - k) * total / n);
      ++out.repeated;
    }
  }
  return out;
}

}  // namespace touchdown::analysis
