// Trials against a theory's boundary angle: counts, bracket, agreement.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "touchdown/analysis/statistics/observation.h"
#include "touchdown/core/estimate.h"

namespace touchdown::analysis {

// A boundary angle that a theory states: below it bodies stay down, above it
// they bounce.
struct TheoryBoundary {
  std::string name;
  double boundary_rad = 0.0;
  double u_rad = 0.0;  // standard uncertainty of the theory's value
};

struct Counts {
  int bounce = 0;
  int not_bounce = 0;
  int undecided = 0;

  int decided() const { return bounce + not_bounce; }
  int total() const { return decided() + undecided; }
  friend bool operator==(const Counts&, const Counts&) = default;
};

Counts Count(std::span<const Observation> observations);

// What the trials alone say, without any model: the boundary lies from the
// greatest angle that did not bounce to the least that did. Exact only for
// exact angles and a boundary that does not scatter; undecided trials do not
// enter. An end is absent where no trial had that outcome.
struct Bracket {
  std::optional<double> low_rad;   // greatest angle that did not bounce
  std::optional<double> high_rad;  // least angle that bounced
  // A body stayed down at a greater angle than one that bounced, or at the
  // same: there is no bracket, and low_rad >= high_rad.
  bool overlap = false;

  bool closed() const { return low_rad && high_rad && !overlap; }
};

Bracket FindBracket(std::span<const Observation> observations);

// Angles that differ by less are equal: degrees do not survive the way through
// radians and back to the last bit.
inline constexpr double kSameAngle_rad = 1e-9;

// Theory against observation, by [predicted][observed].
struct ConfusionMatrix {
  int slide_slide = 0;
  int slide_bounce = 0;  // theory: slides; seen: bounced
  int bounce_slide = 0;  // theory: bounces; seen: stayed down
  int bounce_bounce = 0;

  int right() const { return slide_slide + bounce_bounce; }
  int total() const { return right() + slide_bounce + bounce_slide; }
  friend bool operator==(const ConfusionMatrix&,
                         const ConfusionMatrix&) = default;
};

// A theory predicts "slide" for a trial exactly at its boundary, as the paper's
// Table 1 has at exactly 11.8 and 7.8 degrees.
struct Agreement {
  TheoryBoundary theory;
  ConfusionMatrix all;       // every decided trial
  ConfusionMatrix deciding;  // without those too close to the boundary
  int decides_nothing = 0;   // decided, but |angle - boundary| <= 2 u
  int undecided = 0;         // motion state undecided
  // Every boundary from low (included) to high has the same agreement with
  // these trials as the theory's value; an end is absent where no trial bounds
  // it. This is what "n of n agree" is worth.
  std::optional<double> same_low_rad;
  std::optional<double> same_high_rad;
};

// Throws std::invalid_argument where the boundary or its u is not finite.
Agreement CompareWithTheory(std::span<const Observation> observations,
                            const TheoryBoundary& theory);

// True where `angle` lies within 2 u of the boundary (95 %), u that of the
// angle (own and common part) and that of the theory together.
bool DecidesNothing(const Observation& observation,
                    const TheoryBoundary& theory);

}  // namespace touchdown::analysis
