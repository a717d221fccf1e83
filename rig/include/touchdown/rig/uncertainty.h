// Uncertainty of a computed number, twice: to first order (JCGM 100, "GUM") and
// by propagating distributions (JCGM 101, Monte Carlo). Where they disagree,
// the first order is wrong.
//
// Inputs are independent and normal. A draw outside (low, high), or for which
// the model has no answer, is counted and left out: `impossible`.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "touchdown/core/estimate.h"
#include "touchdown/core/expected.h"
#include "touchdown/rig/spring.h"

namespace touchdown::rig {

struct UncertainInput {
  std::string name;
  core::Estimate estimate;  // u >= 0; u = 0 is a constant
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

// Values of the inputs, in their order -> values of the outputs, or why there
// are none. It must return the same number of outputs each time.
using Model =
    std::function<core::Expected<std::vector<double>>(std::span<const double>)>;

struct FirstOrder {
  core::Estimate estimate;  // the model at the inputs' values, and its u
  core::Budget budget;      // |dy/dx| u(x) of each input with u > 0
};

// One FirstOrder an output, or why the model has no answer. Sensitivities are
// central differences over +-1e-3 u(x) (cf. JCGM 100, 5.1.3 note 2), one-sided
// where the model has no answer on one side; their own error is about 1e-6.
// Throws std::invalid_argument where an input's u is negative or not finite.
core::Expected<std::vector<FirstOrder>> PropagateFirstOrder(
    std::span<const UncertainInput> inputs, const Model& model);

struct MonteCarlo {
  double mean = 0.0;
  double u = 0.0;             // standard deviation of the draws
  double u_of_u = 0.0;        // its own standard error, u / sqrt(2 draws)
  core::Interval interval95;  // 2.5 % and 97.5 % quantiles
};

struct MonteCarloRun {
  std::size_t draws = 0;            // asked for
  std::size_t impossible = 0;       // of these, without an answer
  std::vector<MonteCarlo> outputs;  // empty where fewer than 2 draws answered
};

// JCGM 101 advises 1e6 draws for a 95 % interval to two digits; 1e5 (u to 0.2
// %, 0.1 s) serve a plan. Throws std::invalid_argument where draws < 2 or as
// above.
MonteCarloRun PropagateMonteCarlo(std::span<const UncertainInput> inputs,
                                  const Model& model, std::size_t draws,
                                  std::mt19937_64& engine);

// JCGM 101, clause 8: the first order is valid where both ends of its interval
// lie within half a unit of the last of `digits` significant digits of u from
// those of the Monte Carlo.
bool FirstOrderIsValid(const core::Estimate& first_order,
                       const MonteCarlo& monte_carlo, int digits = 1);

// Relative standard uncertainties (u/value) of what Eq. (10) and (11) take.
struct IdealRelativeU {
  double shear_modulus = 0.0;
  double wire_diameter = 0.0;
  double active_coils = 0.0;
  double coil_diameter = 0.0;  // of the kind that was measured
  double compression = 0.0;
  double mass = 0.0;
};

struct IdealSpeedU {
  double u_rel = 0.0;     // u(v)/v, first order
  double bias_rel = 0.0;  // (E[v] - v)/v, second order
};

// Closed form for v = X sqrt(H/m), H of Eq. (11) with the mean diameter. The
// mean depends on the wire where outer or inner is measured, so that the
// exponent of d is 2 + 1.5 d/D_m (outer), 2 - 1.5 d/D_m (inner), 2 (mean), and
// that of D is -1.5 D/D_m. Throws like MeanDiameter, or where a u is negative.
IdealSpeedU IdealSpeedUncertainty(const Spring& spring,
                                  const IdealRelativeU& u);

// The same for Eq. (11) as printed, the outer diameter in the place of the
// mean: exponents 2 and -1.5.
IdealSpeedU PrintedSpeedUncertainty(const IdealRelativeU& u);

// v/v(inputs) by Monte Carlo, for the same inputs as IdealSpeedUncertainty: the
// one output of the run. Draws in the order of IdealRelativeU's fields.
MonteCarloRun IdealSpeedMonteCarlo(const Spring& spring,
                                   const IdealRelativeU& u, std::size_t draws,
                                   std::mt19937_64& engine);

}  // namespace touchdown::rig
