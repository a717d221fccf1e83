#include "detection/path_linking.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

namespace touchdown::vision {
namespace {

// Cost for each scatter of way, in units of the cost of one scatter off a
// straight line: of two paths that are as smooth, the slower one. Not studied.
constexpr double kWayCost = 0.02;

// Cost of three successive places: squared second difference (acceleration)
// over the scatter, the way, and the squared turn of a rectangle. The bound
// costs.most lets an impact through.
double TransitionCost(const PlacedShape& before, const PlacedShape& last,
                      const PlacedShape& next, const PathCosts& costs) {
  const double way_x = next.centre.x_px - last.centre.x_px;
  const double way_y = next.centre.y_px - last.centre.y_px;
  const double bend_x = way_x - (last.centre.x_px - before.centre.x_px);
  const double bend_y = way_y - (last.centre.y_px - before.centre.y_px);
  const double square = costs.scatter * costs.scatter;
  double cost = (bend_x * bend_x + bend_y * bend_y) / (2.0 * square) +
                kWayCost * std::hypot(way_x, way_y) / costs.scatter;
  if (costs.period_rad > 0.0) {
    const double turn =
        std::remainder(next.angle_rad - last.angle_rad, costs.period_rad);
    cost += turn * turn / (2.0 * costs.turn_rad * costs.turn_rad);
  }
  return std::min(cost, costs.most);
}

}  // namespace

LinkedPath LinkPath(std::span<const std::vector<PlacedShape>> frames,
                    const PathCosts& costs) {
  // A second difference takes three.
  constexpr std::size_t kMinFrames = 3;
  if (frames.size() < kMinFrames) {
    throw std::invalid_argument("LinkPath: " + std::to_string(frames.size()) +
                                " frames; it takes 3 or more");
  }
  for (std::size_t t = 0; t < frames.size(); ++t) {
    if (frames[t].empty()) {
      throw std::invalid_argument("LinkPath: frame " + std::to_string(t) +
                                  " has no candidate; each must have one");
    }
  }
  const auto own_cost = [&](const PlacedShape& shape) {
    return (1.0 - shape.score) / costs.score_variance;
  };
  // Viterbi's algorithm with pairs of candidates as states: cost[i * n + j] is
  // that of the best path that ends with candidates i and j of frames t - 1 and
  // t.
  std::vector<double> cost;
  for (const PlacedShape& first : frames[0]) {
    for (const PlacedShape& second : frames[1]) {
      cost.push_back(own_cost(first) + own_cost(second));
    }
  }
  std::vector<std::vector<std::uint32_t>> backward(frames.size());
  for (std::size_t t = 2; t < frames.size(); ++t) {
    const auto& before = frames[t - 2];
    const auto& last = frames[t - 1];
    const auto& next = frames[t];
    std::vector<double> extended(last.size() * next.size());
    backward[t].resize(extended.size());
    for (std::size_t j = 0; j < last.size(); ++j) {
      for (std::size_t k = 0; k < next.size(); ++k) {
        double least = std::numeric_limits<double>::infinity();
        std::size_t from = 0;
        for (std::size_t i = 0; i < before.size(); ++i) {
          const double sum = cost[i * last.size() + j] +
                             TransitionCost(before[i], last[j], next[k], costs);
          if (sum < least) {
            least = sum;
            from = i;
          }
        }
        extended[j * next.size() + k] = least + own_cost(next[k]);
        backward[t][j * next.size() + k] = static_cast<std::uint32_t>(from);
      }
    }
    cost = std::move(extended);
  }
  // The cheapest end, then backwards.
  const auto best = std::min_element(cost.begin(), cost.end());
  const std::size_t width = frames.back().size();
  auto pair = static_cast<std::size_t>(best - cost.begin());
  LinkedPath path;
  path.cost = *best / static_cast<double>(frames.size());
  path.chosen.resize(frames.size());
  std::size_t last = pair / width;
  std::size_t next = pair % width;
  for (std::size_t t = frames.size() - 1; t >= 2; --t) {
    path.chosen[t] = next;
    const std::size_t before = backward[t][last * frames[t].size() + next];
    next = last;
    last = before;
  }
  path.chosen[1] = next;
  path.chosen[0] = last;
  return path;
}

}  // namespace touchdown::vision
