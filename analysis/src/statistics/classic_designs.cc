#include "touchdown/analysis/statistics/classic_designs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "statistics/feasible.h"
#include "touchdown/analysis/statistics/agreement.h"
#include "touchdown/analysis/statistics/probit_fit.h"
#include "touchdown/core/normal.h"
#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

// Levels are printed to two decimals: 4.2 - 4.1 is no more than 0.1.
constexpr double kSameGap = 1e-9;

double InformationWeight(double k) {
  const double density = core::NormalDensity(k);
  const double both = core::NormalCdf(k) * core::NormalCdf(-k);
  return both > 0.0 ? density * density / both : 0.0;
}

// Neyer's D-optimal level: the one that adds most to the determinant of the
// information on (mean, scatter).
double DOptimal(std::span<const double> levels, double mean, double scatter) {
  double b11 = 0.0;
  double b12 = 0.0;
  double b22 = 0.0;
  for (const double x : levels) {
    const double k = (x - mean) / scatter;
    const double w = InformationWeight(k);
    b11 += w;
    b12 += w * k;
    b22 += w * k * k;
  }
  const double side = b12 > 0.0 ? -1.0 : 1.0;
  const auto gain = [&](double k) {
    return InformationWeight(k) * (b11 * k * k - 2 * b12 * k + b22);
  };
  // A scan and a golden section around its best: beyond 8 nothing is gained.
  constexpr double kFar = 8.0;
  constexpr int kSteps = 400;
  int best = 0;
  double best_gain = gain(0.0);
  for (int i = 1; i <= kSteps; ++i) {
    const double g = gain(side * kFar * i / kSteps);
    if (g > best_gain) {
      best_gain = g;
      best = i;
    }
  }
  double low = kFar * std::max(best - 1, 0) / kSteps;
  double high = kFar * (best + 1) / kSteps;
  const double golden = (std::sqrt(5.0) - 1.0) / 2.0;
  while (high - low > 1e-9) {
    const double a = high - golden * (high - low);
    const double b = low + golden * (high - low);
    (gain(side * a) >= gain(side * b) ? high : low) =
        gain(side * a) >= gain(side * b) ? b : a;
  }
  return mean + side * (low + high) / 2 * scatter;
}

struct TriedRange {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

TriedRange MeasureTriedRange(std::span<const Observation> trials) {
  TriedRange out;
  for (const Observation& o : trials) {
    out.low = std::min(out.low, o.angle_rad);
    out.high = std::max(out.high, o.angle_rad);
  }
  return out;
}

std::vector<double> TriedAngles(std::span<const Observation> trials) {
  std::vector<double> out;
  for (const Observation& o : trials) out.push_back(o.angle_rad);
  return out;
}

// The level that adds most once outcomes overlap: about the greatest
// likelihood, kept inside what was tried.
double DOptimalAfterOverlap(std::span<const Observation> trials) {
  const TriedRange all = MeasureTriedRange(trials);
  const auto fit = FitProbit(trials);
  const Bracket bracket = FindBracket(trials);
  const double mean =
      fit ? fit->mean : (*bracket.high_rad + *bracket.low_rad) / 2;
  const double scatter = fit ? fit->scatter : all.high - all.low;
  return DOptimal(TriedAngles(trials), std::clamp(mean, all.low, all.high),
                  std::min(scatter, all.high - all.low));
}

// One step of Neyer's rules after `trials`; `guess` shrinks on the way.
double NeyerLevel(std::span<const Observation> trials,
                  const DesignGuess& options, double& guess) {
  if (trials.empty()) {
    return (options.guess_low_rad + options.guess_high_rad) / 2;
  }
  const TriedRange all = MeasureTriedRange(trials);
  const Counts counts = Count(trials);
  if (counts.bounce == 0) {
    return std::max({(options.guess_high_rad + all.high) / 2,
                     all.high + 2 * guess, 2 * all.high - all.low});
  }
  if (counts.not_bounce == 0) {
    return std::min({(options.guess_low_rad + all.low) / 2, all.low - 2 * guess,
                     2 * all.low - all.high});
  }
  const Bracket bracket = FindBracket(trials);
  const double gap = *bracket.high_rad - *bracket.low_rad;
  const double middle = (*bracket.high_rad + *bracket.low_rad) / 2;
  if (gap > guess * (1 + kSameGap)) return middle;
  if (gap >= 0.0) {
    const double scatter = std::min(guess, all.high - all.low);
    guess *= 0.8;
    return DOptimal(TriedAngles(trials), middle, scatter);
  }
  return DOptimalAfterOverlap(trials);
}

// Goes through a test again: Throw() takes the trials one by one for the levels
// that the rules ask for, whatever was set in fact.
class Replay {
 public:
  explicit Replay(std::span<const Observation> trials) : trials_(trials) {}

  // False where that trial has not been thrown yet: `level` is the next.
  bool Throw(double level) {
    if (used_ == trials_.size()) {
      wanted_ = level;
      return false;
    }
    ++used_;
    return true;
  }
  bool bounced() const {
    return trials_[used_ - 1].outcome == Outcome::kBounce;
  }
  std::span<const Observation> thrown() const { return trials_.first(used_); }
  double wanted() const { return wanted_; }

 private:
  std::span<const Observation> trials_;
  std::size_t used_ = 0;
  double wanted_ = 0.0;
};

// Phase I1: until both outcomes were seen. False: the next level is wanted.
bool FindBothOutcomes(const DesignGuess& guess, Replay& replay) {
  const double low = guess.guess_low_rad;
  const double high = guess.guess_high_rad;
  double scatter = guess.guess_scatter_rad;  // of this phase only
  if (!replay.Throw(0.75 * low + 0.25 * high)) return false;
  const bool first = replay.bounced();
  if (!replay.Throw(0.25 * low + 0.75 * high)) return false;
  const bool second = replay.bounced();
  if (first != second) {
    // The wrong way round: look far to both sides.
    return !first || (replay.Throw(low - 3 * scatter) &&
                      replay.Throw(high + 3 * scatter));
  }
  // Outward in growing steps; every third doubles the scatter.
  double level = first ? low : high;
  for (int i = 1;; ++i) {
    if (i % 3 == 0) scatter *= 2;
    level += (first ? -1.5 : 1.5) * i * scatter;
    if (!replay.Throw(level)) return false;
    if (replay.bounced() != first) return true;
  }
}

// Phase I2: until outcomes overlap. `scatter` is the guess; it shrinks by a
// third where the probes on both sides say nothing new.
bool FindOverlap(Replay& replay, double& scatter) {
  for (;;) {
    const Bracket bracket = FindBracket(replay.thrown());
    const double gap = *bracket.high_rad - *bracket.low_rad;
    // Both outcomes at one level are no overlap: the fit would not exist.
    if (gap < 0.0) return true;
    if (gap >= 1.5 * scatter) {
      if (!replay.Throw((*bracket.high_rad + *bracket.low_rad) / 2)) {
        return false;
      }
      continue;
    }
    // The side with fewer outcomes of its own is probed first.
    const Counts counts = Count(replay.thrown());
    bool above = counts.not_bounce > counts.bounce;
    for (int probe = 0; probe < 2; ++probe, above = !above) {
      const Bracket now = FindBracket(replay.thrown());
      if (!replay.Throw(above ? *now.high_rad + 0.3 * scatter
                              : *now.low_rad - 0.3 * scatter)) {
        return false;
      }
      // Beyond the bracket the other outcome is an overlap.
      if (replay.bounced() != above) return true;
    }
    scatter *= 2.0 / 3;
  }
}

// Phase I3: two levels, or one, about the middle of the overlap.
bool EnhanceOverlap(Replay& replay, double scatter) {
  const Bracket bracket = FindBracket(replay.thrown());
  const double middle = (*bracket.high_rad + *bracket.low_rad) / 2;
  if (scatter + *bracket.high_rad - *bracket.low_rad <= 0.0) {
    return replay.Throw(middle);
  }
  return replay.Throw(middle + scatter / 2) &&
         replay.Throw(middle - scatter / 2);
}

double ThreePhaseLevel(std::span<const Observation> trials,
                       const DesignGuess& guess) {
  Replay replay(trials);
  double scatter = guess.guess_scatter_rad;
  if (FindBothOutcomes(guess, replay) && FindOverlap(replay, scatter) &&
      EnhanceOverlap(replay, scatter)) {
    return DOptimalAfterOverlap(trials);
  }
  return replay.wanted();
}

void CheckGuess(const DesignGuess& options) {
  CheckFeasible(options.feasible_rad);
  core::Require(options.guess_high_rad > options.guess_low_rad,
                "guess_high_rad", options.guess_high_rad,
                "above guess_low_rad");
  core::Require(options.guess_scatter_rad > 0.0, "guess_scatter_rad",
                options.guess_scatter_rad, "positive");
}

std::vector<Observation> Decided(std::span<const Observation> trials) {
  std::vector<Observation> out;
  for (const Observation& o : trials) {
    if (o.outcome != Outcome::kUndecided) out.push_back(o);
  }
  return out;
}

}  // namespace

NextAngle NextNeyer(std::span<const Observation> trials,
                    const DesignGuess& options) {
  CheckGuess(options);
  const std::vector<Observation> decided = Decided(trials);
  // The guess of the scatter shrinks along the way, so the test is replayed;
  // fits are needed only for the last level.
  double guess = options.guess_scatter_rad;
  const std::span<const Observation> all(decided);
  for (std::size_t n = 1; n < all.size(); ++n) {
    const auto before = all.first(n);
    const Counts counts = Count(before);
    if (counts.bounce == 0 || counts.not_bounce == 0) continue;
    const Bracket bracket = FindBracket(before);
    const double gap = *bracket.high_rad - *bracket.low_rad;
    if (gap >= 0.0 && gap <= guess * (1 + kSameGap)) guess *= 0.8;
  }
  return Clipped(NeyerLevel(all, options, guess), options.feasible_rad);
}

NextAngle NextThreePhase(std::span<const Observation> trials,
                         const DesignGuess& options) {
  CheckGuess(options);
  return Clipped(ThreePhaseLevel(Decided(trials), options),
                 options.feasible_rad);
}

NextAngle NextUpDown(std::span<const Observation> trials,
                     const UpDownOptions& options) {
  CheckFeasible(options.feasible_rad);
  core::Require(options.step_rad > 0.0, "step_rad", options.step_rad,
                "positive");
  if (trials.empty()) return Clipped(options.start_rad, options.feasible_rad);
  const Observation& last = trials.back();
  // The set-point where it is known: measured angles would wander off the
  // steps.
  double angle = last.set_angle_rad.value_or(last.angle_rad);
  if (last.outcome == Outcome::kBounce) angle -= options.step_rad;
  if (last.outcome == Outcome::kNotBounce) angle += options.step_rad;
  return Clipped(angle, options.feasible_rad);
}

}  // namespace touchdown::analysis
