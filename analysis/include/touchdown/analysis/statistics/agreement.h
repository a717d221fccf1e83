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

// What a theory predicts for a trial exactly at its boundary. The paper's
// Table 1 has "slide" at exactly 11.8 and 7.8 degrees, so that is the default.
enum class TieRule { kSlidesAtBoundary, kBouncesAtBoundary };

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

struct AgreementOptions {
  TieRule tie_rule = TieRule::kSlidesAtBoundary;
  // A trial decides nothing about a theory when its angle lies within this
  // many standard uncertainties of the theory's value: 2, i.e. 95 %.
  double coverage_factor = 2.0;
};

struct Agreement {
  TheoryBoundary theory;
  ConfusionMatrix all;       // every decided trial, ties by the tie rule
  ConfusionMatrix deciding;  // without those too close to the boundary
  int decides_nothing = 0;   // decided, but |angle - boundary| <= 2 u
  int undecided = 0;         // motion state undecided
  // Every boundary from low to high (half open as the tie rule says) has the
  // same agreement with these trials as the theory's value; an end is absent
  // where no trial bounds it. This is what "n of n agree" is worth.
  std::optional<double> same_low_rad;
  std::optional<double> same_high_rad;
};

// Throws std::invalid_argument where the boundary or its u is not finite or
// coverage_factor < 0.
Agreement CompareWithTheory(std::span<const Observation> observations,
                            const TheoryBoundary& theory,
                            const AgreementOptions& options = {});

// True where `angle` lies within coverage_factor * u of the boundary, u that of
// the angle (own and common part) and that of the theory together.
bool DecidesNothing(const Observation& observation,
                    const TheoryBoundary& theory, double coverage_factor = 2.0);

}  // namespace touchdown::analysis
