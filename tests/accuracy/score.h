// One case analysed and compared with its truth and its bound, and sums of
// many.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "app/measure/analyze.h"
#include "tests/accuracy/bound.h"
#include "tests/accuracy/design.h"
#include "touchdown/core/trial.h"

namespace touchdown::accuracy {

enum Quantity { kApproach, kFrame, kFace, kRadius, kQuantities };
inline constexpr const char* kQuantityNames[kQuantities] = {
    "approach angle", "contact time", "face angle", "radius angle"};

// One measured quantity of one clip; angles in rad, time in frames.
struct Reading {
  double error = 0.0;
  double u = 0.0;
  bool covered = false;  // by the 95 % interval
  double bound = 0.0;
};

struct Outcome {
  Case made;
  // Nothing where it was not measured (reason says why) or does not exist
  // (reason empty).
  std::array<std::optional<Reading>, kQuantities> readings;
  std::array<std::string, kQuantities> reasons;
  core::MotionState state = core::MotionState::kUndecided;
  std::string state_reason;
  double bounce_height_m = 0.0;
  double u_gap_m = 0.0;  // of the greatest gap
  double seconds = 0.0;
};

// What `analyze` is told of a case.
pipeline::AnalyzeOptions Told(const Case& c);

// The case rendered, analysed and compared.
Outcome Analyse(const Case& c);
std::vector<Outcome> AnalyseAll(const std::vector<Case>& cases);  // all cores

// An analysis' first contact against the case's truth and bound.
Outcome Compare(const Case& c, const core::ContactRecord& first);

// 95 % interval of the root mean square of at least one error: bootstrap.
core::Interval RmsInterval95(const std::vector<double>& errors);

// Over many clips: failures are counted, never averaged in.
struct Sum {
  std::size_t expected = 0;
  std::size_t measured = 0;
  std::size_t covered = 0;
  double square_of_ratio = 0.0;  // error / bound
  double square = 0.0;           // error
  double z = 0.0;                // error / u
  double z2 = 0.0;

  double RmseOverBound() const;
  double Rmse() const;
  double Coverage() const;
  // Mean of error / u, and half its 99 % band (2.576 standard errors).
  double MeanZ() const;
  double MeanZBand() const;
  core::Interval CoverageBand() const;  // Wilson, 99 %
};
void Add(Sum& sum, const Outcome& outcome, Quantity quantity);

// Labels of cases with a known rise. A case is clear where the rise is off the
// bounce height by more than twice its u, far where by more than four times.
struct States {
  std::size_t cases = 0;
  std::size_t clear = 0;
  std::size_t far = 0;
  std::size_t false_bounces = 0;   // of the clear ones
  std::size_t missed_bounces = 0;  //
  std::size_t undecided = 0;       // of the far ones
};
void Add(States& states, const Outcome& outcome);

}  // namespace touchdown::accuracy
