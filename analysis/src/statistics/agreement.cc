#include "touchdown/analysis/statistics/agreement.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "touchdown/core/units.h"

namespace touchdown::analysis {
namespace {

bool PredictsBounce(double angle_rad, double boundary_rad) {
  return angle_rad > boundary_rad + kSameAngle_rad;
}

void Tally(ConfusionMatrix& matrix, bool predicted_bounce, bool bounced) {
  if (predicted_bounce) {
    ++(bounced ? matrix.bounce_bounce : matrix.bounce_slide);
  } else {
    ++(bounced ? matrix.slide_bounce : matrix.slide_slide);
  }
}

int CountRight(std::span<const Observation> observations, double boundary_rad) {
  int right = 0;
  for (const Observation& o : observations) {
    if (o.outcome == Outcome::kUndecided) continue;
    const bool bounced = o.outcome == Outcome::kBounce;
    right += PredictsBounce(o.angle_rad, boundary_rad) == bounced ? 1 : 0;
  }
  return right;
}

// Agreement is constant between neighbouring angles of decided trials, so one
// probe in each gap tells it. The walk goes outwards from the theory's value.
void FindSameAgreement(std::span<const Observation> observations,
                       Agreement& out) {
  std::vector<double> angles;
  for (const Observation& o : observations) {
    if (o.outcome != Outcome::kUndecided) angles.push_back(o.angle_rad);
  }
  std::sort(angles.begin(), angles.end());
  angles.erase(
      std::unique(angles.begin(), angles.end(),
                  [](double a, double b) { return b - a <= kSameAngle_rad; }),
      angles.end());
  if (angles.empty()) return;
  const int right = out.all.right();
  // `below` counts the angles whose prediction is "bounces no more": gap k lies
  // between angles[k-1] and angles[k], a tied angle below it.
  const double theory = out.theory.boundary_rad;
  std::size_t gap = 0;
  while (gap < angles.size() && !PredictsBounce(angles[gap], theory)) {
    ++gap;
  }
  const auto probe = [&](std::size_t k) {
    if (k == 0) return angles.front() - 1.0;
    if (k == angles.size()) return angles.back() + 1.0;
    return (angles[k - 1] + angles[k]) / 2;
  };
  std::size_t low = gap;
  while (low > 0 && CountRight(observations, probe(low - 1)) == right) {
    --low;
  }
  std::size_t high = gap;
  while (high < angles.size() &&
         CountRight(observations, probe(high + 1)) == right) {
    ++high;
  }
  if (low > 0) out.same_low_rad = angles[low - 1];
  if (high < angles.size()) out.same_high_rad = angles[high];
}

}  // namespace

Counts Count(std::span<const Observation> observations) {
  Counts counts;
  for (const Observation& o : observations) {
    switch (o.outcome) {
      case Outcome::kBounce:
        ++counts.bounce;
        break;
      case Outcome::kNotBounce:
        ++counts.not_bounce;
        break;
      case Outcome::kUndecided:
        ++counts.undecided;
        break;
    }
  }
  return counts;
}

Bracket FindBracket(std::span<const Observation> observations) {
  Bracket out;
  for (const Observation& o : observations) {
    if (o.outcome == Outcome::kNotBounce) {
      out.low_rad = std::max(out.low_rad.value_or(o.angle_rad), o.angle_rad);
    } else if (o.outcome == Outcome::kBounce) {
      out.high_rad = std::min(out.high_rad.value_or(o.angle_rad), o.angle_rad);
    }
  }
  out.overlap = out.low_rad && out.high_rad && *out.low_rad >= *out.high_rad;
  return out;
}

bool DecidesNothing(const Observation& observation,
                    const TheoryBoundary& theory) {
  return std::abs(observation.angle_rad - theory.boundary_rad) <=
         2.0 * std::hypot(TotalU(observation), theory.u_rad) + kSameAngle_rad;
}

Agreement CompareWithTheory(std::span<const Observation> observations,
                            const TheoryBoundary& theory) {
  if (!std::isfinite(theory.boundary_rad) || !(theory.u_rad >= 0.0) ||
      !std::isfinite(theory.u_rad)) {
    throw std::invalid_argument(fmt::format(
        "theory {}: boundary_rad is {} and u_rad is {}; the boundary must be "
        "finite and u finite and not negative",
        theory.name, theory.boundary_rad, theory.u_rad));
  }
  Agreement out;
  out.theory = theory;
  for (const Observation& o : observations) {
    if (o.outcome == Outcome::kUndecided) {
      ++out.undecided;
      continue;
    }
    const bool bounced = o.outcome == Outcome::kBounce;
    const bool predicted = PredictsBounce(o.angle_rad, theory.boundary_rad);
    Tally(out.all, predicted, bounced);
    if (DecidesNothing(o, theory)) {
      ++out.decides_nothing;
    } else {
      Tally(out.deciding, predicted, bounced);
    }
  }
  FindSameAgreement(observations, out);
  return out;
}

}  // namespace touchdown::analysis
