// How many trials more: the rule played forward from what is believed now.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "statistics/design.h"
#include "statistics/likelihood.h"
#include "touchdown/analysis/statistics/next_angle.h"
#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

// Steps of the forecast's own grid per target half-width: quantiles between
// them are interpolated.
constexpr double kStepsPerTarget = 4.0;
// With more angles than this the grid begins coarser, and becomes finer as the
// belief gets narrower.
constexpr std::size_t kMostAngles = 120;
// Neighbouring scatters of the posterior that become one.
constexpr std::size_t kScattersPerLevel = 3;
// What lies outside these quantiles is left out.
constexpr double kTail = 1e-4;
// Angles whose share is below this of the greatest are dropped on the way.
constexpr double kForgotten = 1e-7;
// Where a trial may be thrown, in standard deviations from the mean.
constexpr double kCandidates[] = {-0.7, 0.0, 0.7};
// After so many trials the interval is taken to narrow as the information says.
constexpr int kMostSteps = 40;
constexpr double kNever = 1e6;  // what the number says beyond

// The posterior on an even grid that gets narrower as trials come in.
struct Belief {
  double first_rad = 0.0;
  double step_rad = 0.0;
  std::vector<double> scatter_rad;
  std::vector<double> weight;  // [angle * scatter + level], sum 1

  std::size_t levels() const { return scatter_rad.size(); }
  std::size_t angles() const { return weight.size() / levels(); }
  double Angle(std::size_t i) const {
    return first_rad + step_rad * static_cast<double>(i);
  }
};

// The share of step i of an uneven grid that is nearer to point i than to its
// neighbours.
core::Interval Extent(const std::vector<double>& points, std::size_t i) {
  return {i > 0 ? (points[i - 1] + points[i]) / 2 : points[i],
          i + 1 < points.size() ? (points[i] + points[i + 1]) / 2 : points[i]};
}

Belief Coarsen(const BoundaryPosterior& posterior, double target_rad) {
  const BoundaryGrid& grid = posterior.grid;
  const std::size_t m = grid.scatter_rad.size();
  const double low = Quantile(posterior, kTail);
  const double high = Quantile(posterior, 1.0 - kTail);
  Belief out;
  out.step_rad = std::max(target_rad / kStepsPerTarget,
                          (high - low) / static_cast<double>(kMostAngles));
  out.first_rad = low + out.step_rad / 2;
  const auto n =
      static_cast<std::size_t>(std::ceil((high - low) / out.step_rad));
  const std::size_t levels = (m + kScattersPerLevel - 1) / kScattersPerLevel;
  for (std::size_t level = 0; level < levels; ++level) {
    const std::size_t begin = level * kScattersPerLevel;
    const std::size_t last = std::min(begin + kScattersPerLevel, m) - 1;
    out.scatter_rad.push_back(
        std::sqrt(grid.scatter_rad[begin] * grid.scatter_rad[last]));
  }
  out.weight.assign(std::max<std::size_t>(n, 1) * levels, 0.0);
  const auto cell = [&](double angle) {
    const double at = std::floor((angle - low) / out.step_rad);
    return static_cast<std::size_t>(
        std::clamp(at, 0.0, static_cast<double>(out.angles() - 1)));
  };
  double total = 0.0;
  for (std::size_t i = 0; i < grid.angle_rad.size(); ++i) {
    const core::Interval extent = Extent(grid.angle_rad, i);
    if (extent.high < low || extent.low > high) continue;
    const std::size_t first = cell(extent.low);
    const std::size_t last = cell(extent.high);
    const double share = 1.0 / static_cast<double>(last - first + 1);
    for (std::size_t j = 0; j < m; ++j) {
      const double w = grid.weight[i * m + j];
      total += w;
      for (std::size_t k = first; k <= last; ++k) {
        out.weight[k * levels + j / kScattersPerLevel] += w * share;
      }
    }
  }
  for (double& w : out.weight) w /= total;
  return out;
}

struct Summary {
  double mean_rad = 0.0;
  double sd_rad = 0.0;
  double half_width_rad = 0.0;
};

Summary Summarize(const Belief& belief) {
  const std::size_t m = belief.levels();
  std::vector<double> mass(belief.angles(), 0.0);
  for (std::size_t k = 0; k < belief.weight.size(); ++k) {
    mass[k / m] += belief.weight[k];
  }
  Summary out;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    out.mean_rad += mass[i] * belief.Angle(i);
  }
  for (std::size_t i = 0; i < mass.size(); ++i) {
    const double d = belief.Angle(i) - out.mean_rad;
    out.sd_rad += mass[i] * d * d;
  }
  out.sd_rad = std::sqrt(out.sd_rad);
  const auto quantile = [&](double p) {
    double below = 0.0;
    for (std::size_t i = 0; i < mass.size(); ++i) {
      if (below + mass[i] >= p && mass[i] > 0.0) {
        return belief.Angle(i) +
               belief.step_rad * ((p - below) / mass[i] - 0.5);
      }
      below += mass[i];
    }
    return belief.Angle(mass.size() - 1);
  };
  out.half_width_rad = (quantile(0.975) - quantile(0.025)) / 2;
  return out;
}

std::vector<double> InverseScatter(const Belief& belief, double u_rad) {
  std::vector<double> out;
  for (const double s : belief.scatter_rad) {
    out.push_back(1.0 / std::hypot(s, u_rad));
  }
  return out;
}

// What a trial at `angle` is expected to take off the variance.
double ExpectedGain(const Belief& belief, const std::vector<double>& inverse,
                    double angle_rad, double mean_rad) {
  const std::size_t m = belief.levels();
  double p = 0.0;
  double p_theta = 0.0;
  for (std::size_t i = 0; i < belief.angles(); ++i) {
    const double theta = belief.Angle(i);
    double q = 0.0;
    for (std::size_t j = 0; j < m; ++j) {
      q += belief.weight[i * m + j] *
           FastNormalCdf((angle_rad - theta) * inverse[j]);
    }
    p += q;
    p_theta += q * (theta - mean_rad);
  }
  return p > 0.0 && p < 1.0 ? p_theta * p_theta / (p * (1.0 - p)) : 0.0;
}

// Bayes' rule for one trial, then drops what is no longer believed.
void Learn(Belief& belief, const std::vector<double>& inverse, double angle_rad,
           bool bounced) {
  const std::size_t m = belief.levels();
  double total = 0.0;
  double greatest = 0.0;
  for (std::size_t i = 0; i < belief.angles(); ++i) {
    const double distance = angle_rad - belief.Angle(i);
    for (std::size_t j = 0; j < m; ++j) {
      const double z = distance * inverse[j];
      // Never quite 0: one impossible outcome must not end the forecast.
      constexpr double kLeast = 1e-12;
      double& w = belief.weight[i * m + j];
      total += w *= std::max(FastNormalCdf(bounced ? z : -z), kLeast);
      greatest = std::max(greatest, w);
    }
  }
  std::size_t first = belief.angles();
  std::size_t last = 0;
  for (std::size_t i = 0; i < belief.angles(); ++i) {
    for (std::size_t j = 0; j < m; ++j) {
      if (belief.weight[i * m + j] < kForgotten * greatest) continue;
      first = std::min(first, i);
      last = i;
    }
  }
  belief.first_rad = belief.Angle(first);
  const auto begin = belief.weight.begin();
  belief.weight.erase(begin + static_cast<std::ptrdiff_t>((last + 1) * m),
                      belief.weight.end());
  belief.weight.erase(begin, begin + static_cast<std::ptrdiff_t>(first * m));
  for (double& w : belief.weight) w /= total;
}

// Halves the steps while they are coarse for the target and few: each half has
// half of what its step had.
void Refine(Belief& belief, double target_rad) {
  const std::size_t m = belief.levels();
  while (belief.step_rad > target_rad / kStepsPerTarget &&
         2 * belief.angles() <= kMostAngles) {
    std::vector<double> halves(2 * belief.weight.size());
    for (std::size_t k = 0; k < halves.size(); ++k) {
      halves[k] = belief.weight[k / m / 2 * m + k % m] / 2;
    }
    belief.weight = std::move(halves);
    belief.first_rad -= belief.step_rad / 4;
    belief.step_rad /= 2;
  }
}

struct Truth {
  double boundary_rad = 0.0;
  double scatter_rad = 0.0;
};

Truth DrawTruth(const BoundaryGrid& grid, std::mt19937_64& engine) {
  std::uniform_real_distribution<double> uniform;
  const double p = uniform(engine);
  const std::size_t m = grid.scatter_rad.size();
  double below = 0.0;
  std::size_t k = 0;
  while (k + 1 < grid.weight.size() && (below += grid.weight[k]) < p) ++k;
  const core::Interval extent = Extent(grid.angle_rad, k / m);
  return {extent.low + (extent.high - extent.low) * uniform(engine),
          grid.scatter_rad[k % m]};
}

// Trials that one future takes until the interval is narrow enough.
double PlayOut(Belief belief, const Truth& truth, double u_rad,
               const ForecastOptions& options, std::mt19937_64& engine) {
  std::normal_distribution<double> normal;
  const std::vector<double> when_set =
      InverseScatter(belief, options.set_u_rad);
  const std::vector<double> when_seen = InverseScatter(belief, u_rad);
  for (int n = 0;; ++n) {
    const Summary now = Summarize(belief);
    if (now.half_width_rad <= options.target_half_width_rad) return n;
    if (n == kMostSteps) {
      // Each further trial brings at most 2 / (pi s^2) on the boundary.
      const double s2 = truth.scatter_rad * truth.scatter_rad + u_rad * u_rad;
      const double target_sd = options.target_half_width_rad / core::kNormal975;
      const double now_sd = now.half_width_rad / core::kNormal975;
      return n + (1 / (target_sd * target_sd) - 1 / (now_sd * now_sd)) *
                     std::numbers::pi * s2 / 2;
    }
    double best_rad = now.mean_rad;
    double best_gain = -1.0;
    for (const double k : kCandidates) {
      const double angle = now.mean_rad + k * now.sd_rad;
      const double gain = ExpectedGain(belief, when_set, angle, now.mean_rad);
      if (gain > best_gain) {
        best_gain = gain;
        best_rad = angle;
      }
    }
    const double angle = best_rad + options.set_u_rad * normal(engine);
    const bool bounced =
        angle > truth.boundary_rad + truth.scatter_rad * normal(engine);
    Learn(belief, when_seen, angle + u_rad * normal(engine), bounced);
    Refine(belief, options.target_half_width_rad);
  }
}

}  // namespace

int ForecastTrials(const BoundaryPosterior& posterior,
                   const ForecastOptions& options, std::mt19937_64& engine) {
  core::RequirePositive("target_half_width_rad", options.target_half_width_rad,
                        "rad");
  core::RequireNotNegative("set_u_rad", options.set_u_rad, "rad");
  core::RequireInRange("futures", options.futures, 1, 10000);
  const double half_width =
      (posterior.interval95_rad.high - posterior.interval95_rad.low) / 2;
  if (half_width <= options.target_half_width_rad) return 0;
  const double u_rad = posterior.typical_u_rad.value_or(options.set_u_rad);
  const Belief belief = Coarsen(posterior, options.target_half_width_rad);
  const Design design = Reweigh(posterior, options.design_scatter);
  std::vector<double> needed;
  for (int i = 0; i < options.futures; ++i) {
    const Truth truth = DrawTruth(design.grid, engine);
    needed.push_back(PlayOut(belief, truth, u_rad, options, engine));
  }
  const auto middle =
      needed.begin() + static_cast<std::ptrdiff_t>(needed.size() / 2);
  std::nth_element(needed.begin(), middle, needed.end());
  // The interval is not narrow enough now, so at least one trial is missing.
  return static_cast<int>(std::clamp(std::ceil(*middle), 1.0, kNever));
}

}  // namespace touchdown::analysis
