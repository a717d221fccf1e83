// The first-order budget against Monte Carlo (JCGM 101): inputs are drawn by
// their stated uncertainties, and the chain from the pose on is run again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "app/measure/analyze.h"
#include "touchdown/core/trial.h"

namespace touchdown::accuracy {

// One trial as the tracker would hand it on, without noise: the best estimates
// of all inputs, with their uncertainties.
struct BudgetTrial {
  std::string name;
  // track, options (ground, scale, calibration) and clip are set.
  pipeline::Analysis analysis;
};

// Representative ones: a sphere and a block in a careful set-up; a turned plane
// through a lens; a flat throw; few frames; a coarse set-up.
std::vector<BudgetTrial> BudgetTrials();

// The trial's first contact with its first-order uncertainties: what `analyze`
// states.
core::ContactRecord FirstOrder(const BudgetTrial& trial);

struct Spread {
  std::string quantity;
  core::Estimate first_order;
  double mean = 0.0;
  double u = 0.0;
  core::Interval interval95;   // probabilistically symmetric
  double u_tolerance = 0.0;    // standard deviation of `u` over the batches
  double end_tolerance = 0.0;  // the same of the interval's ends, the larger
  std::size_t draws = 0;
  std::size_t absent = 0;  // draws in which the quantity was not measured
  // JCGM 101, 7.9.2: half a unit of the last of `digits` significant digits of
  // u; the first-order interval agrees if both its ends are within it (8.1).
  double Tolerance(int digits) const;
  double FarthestEnd() const;  // |end - end|, the larger
};

struct DrawOptions {
  std::size_t batch = 2000;  // draws
  std::size_t least = 2;     // batches
  std::size_t most = 500;    // batches
  int digits = 1;            // significant, of u
};

// Adaptive (JCGM 101, 7.9.4): batches are added until twice the standard
// deviation of the means over batches of u and of both ends is below a fifth of
// the tolerance, for every quantity, or `most` is reached.
std::vector<Spread> DrawnSpreads(const BudgetTrial& trial,
                                 const DrawOptions& options,
                                 std::mt19937_64& engine);

}  // namespace touchdown::accuracy
