#include "touchdown/analysis/statistics/set_angles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "touchdown/analysis/statistics/agreement.h"
#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

// Trials at one set angle, by index.
struct SetAngle {
  std::vector<std::size_t> members;
  double mean_rad = 0.0;  // of measured less set
  double mean_square_u_rad2 = 0.0;

  double n() const { return static_cast<double>(members.size()); }
};

// The set angles of one set-up.
struct SetUp {
  std::vector<SetAngle> set_angles;
  double trials = 0.0;
};

double Residual_rad(const Observation& o) {
  return o.angle_rad - *o.set_angle_rad;
}

bool WasTyped(std::span<const Observation> observations,
              const std::vector<std::size_t>& members) {
  const Observation& first = observations[members.front()];
  if (members.size() == 1)
    return std::abs(Residual_rad(first)) < kSameAngle_rad;
  return std::all_of(members.begin(), members.end(), [&](std::size_t i) {
    return std::abs(observations[i].angle_rad - first.angle_rad) <
           kSameAngle_rad;
  });
}

SetAngle MakeSetAngle(std::span<const Observation> observations,
                      std::vector<std::size_t> members) {
  SetAngle out{std::move(members)};
  for (const std::size_t i : out.members) {
    const Observation& o = observations[i];
    out.mean_rad += Residual_rad(o) / out.n();
    out.mean_square_u_rad2 += o.u_rad * o.u_rad / out.n();
  }
  return out;
}

std::vector<SetUp> FindSetAngles(std::span<const Observation> observations) {
  std::map<int, std::vector<std::size_t>> by_setup;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (observations[i].set_angle_rad) {
      by_setup[observations[i].setup].push_back(i);
    }
  }
  std::vector<SetUp> out;
  for (auto& [number, order] : by_setup) {
    const auto set = [&](std::size_t i) {
      return *observations[i].set_angle_rad;
    };
    std::stable_sort(
        order.begin(), order.end(),
        [&](std::size_t a, std::size_t b) { return set(a) < set(b); });
    SetUp setup;
    for (auto first = order.begin(); first != order.end();) {
      const auto last = std::find_if(first, order.end(), [&](std::size_t i) {
        return set(i) - set(*first) > kSameAngle_rad;
      });
      const std::vector<std::size_t> members(first, last);
      if (!WasTyped(observations, members)) {
        setup.set_angles.push_back(MakeSetAngle(observations, members));
        setup.trials += setup.set_angles.back().n();
      }
      first = last;
    }
    if (setup.trials > 1.0) out.push_back(std::move(setup));
  }
  return out;
}

struct Variances {
  double within_rad2 = 0.0;
  double between_rad2 = 0.0;
};

// Analysis of variance of measured less set. Of each square, what the
// measurement's own error puts there is taken off.
Variances EstimateVariances(std::span<const Observation> observations,
                            const std::vector<SetUp>& setups,
                            const SetAngleOptions& options) {
  double freedom_within = options.worth_trials;
  double within = options.worth_trials * options.set_u_rad * options.set_u_rad;
  double freedom_between = 0.0;
  double between = 0.0;
  double per_between = 0.0;  // of between^2 in the expected sum of squares
  for (const SetUp& setup : setups) {
    double mean = 0.0;
    for (const SetAngle& s : setup.set_angles) {
      mean += s.n() * s.mean_rad / setup.trials;
    }
    for (const SetAngle& s : setup.set_angles) {
      for (const std::size_t i : s.members) {
        const double d = Residual_rad(observations[i]) - s.mean_rad;
        within += d * d;
      }
      within -= s.mean_square_u_rad2 * (s.n() - 1.0);
      freedom_within += s.n() - 1.0;
      const double d = s.mean_rad - mean;
      const double share = 1.0 - s.n() / setup.trials;
      between += s.n() * d * d - s.mean_square_u_rad2 * share;
      per_between += s.n() * share;
    }
    freedom_between += static_cast<double>(setup.set_angles.size()) - 1.0;
  }
  Variances out;
  if (freedom_within > 0.0)
    out.within_rad2 = std::max(within / freedom_within, 0.0);
  const double excess = between - freedom_between * out.within_rad2;
  if (per_between > 0.0 && excess > 0.0) {
    out.between_rad2 = excess / per_between;
  } else if (const double freedom = freedom_within + freedom_between;
             freedom > 0.0) {
    out.within_rad2 = std::max((within + between) / freedom, 0.0);
  }
  return out;
}

// Of the mean of the trials at a set angle, about the ejector's own deviation.
double MeanVariance(const SetAngle& s, const Variances& v) {
  return (v.within_rad2 + s.mean_square_u_rad2) / s.n();
}

void DrawTowardsSetAngles(const SetUp& setup, const Variances& v,
                          std::span<Observation> observations) {
  double weights = 0.0;
  double offset = 0.0;
  for (const SetAngle& s : setup.set_angles) {
    const double total = v.between_rad2 + MeanVariance(s, v);
    // Neither scatter nor error: nothing to draw.
    if (!(total > 0.0)) return;
    weights += 1.0 / total;
    offset += s.mean_rad / total;
  }
  offset /= weights;
  for (const SetAngle& s : setup.set_angles) {
    const double own = MeanVariance(s, v);
    const double b = v.between_rad2 / (v.between_rad2 + own);
    const double mean = offset + b * (s.mean_rad - offset);
    const double variance = b * own + (1.0 - b) * (1.0 - b) / weights;
    for (const std::size_t i : s.members) {
      Observation& o = observations[i];
      const double u2 = o.u_rad * o.u_rad;
      if (!(v.within_rad2 + u2 > 0.0)) continue;
      const double k = v.within_rad2 / (v.within_rad2 + u2);
      o.angle_rad = *o.set_angle_rad + mean + k * (Residual_rad(o) - mean);
      o.u_rad = std::sqrt(k * u2 + (1.0 - k) * (1.0 - k) * variance);
    }
  }
}

}  // namespace

SetAngleUse UseSetAngles(std::span<const Observation> observations,
                         const SetAngleOptions& options) {
  core::RequireNotNegative("set_u_rad", options.set_u_rad);
  core::RequireNotNegative("worth_trials", options.worth_trials);
  SetAngleUse out;
  out.observations.assign(observations.begin(), observations.end());
  const std::vector<SetUp> setups = FindSetAngles(observations);
  if (setups.empty()) return out;
  const Variances v = EstimateVariances(observations, setups, options);
  out.within_rad = std::sqrt(v.within_rad2);
  out.between_rad = std::sqrt(v.between_rad2);
  for (const SetUp& setup : setups) {
    DrawTowardsSetAngles(setup, v, out.observations);
    out.used += static_cast<int>(setup.trials);
  }
  return out;
}

}  // namespace touchdown::analysis
