// From a rig and its setting to the contact that will follow, with uncertainty.
#pragma once

#include <cstddef>
#include <optional>
#include <random>
#include <vector>

#include "touchdown/core/estimate.h"
#include "touchdown/core/words.h"
#include "touchdown/rig/description.h"
#include "touchdown/rig/finding.h"
#include "touchdown/rig/uncertainty.h"

namespace touchdown::rig {

// What the operator sets.
struct Setting {
  double compression_m = 0.0;    // X, travel beyond the preload
  double elevation_rad = 0.0;    // of the barrel
  double muzzle_height_m = 0.0;  // of the body's centre at the muzzle
};

// One predicted number, by both ways of uncertainty.h.
struct Predicted {
  core::Measured first_order = core::AbsentBecause("not computed");
  core::Expected<MonteCarlo> monte_carlo = core::AbsentBecause("not computed");
  core::Budget budget;             // of the first order, largest first
  bool first_order_valid = false;  // JCGM 101, clause 8, to one digit
};

struct ContactPrediction {
  Predicted stiffness_n_per_m;
  Predicted launch_speed_mps;
  Predicted impact_speed_mps;
  Predicted approach_angle_rad;
  Predicted radius_angle_rad;  // rectangles only
  Predicted face_angle_rad;    // rectangles only
  Predicted flight_time_s;
  Predicted range_m;
  std::optional<core::Corner> corner;  // rectangles; at the inputs' values
  double p_no_contact = 0.0;  // share of draws that never leave or never land
  std::size_t draws = 0;
  std::vector<Finding> findings;
};

struct PredictOptions {
  // Monte Carlo draws. 1e5: u to 0.2 % and interval ends to about 1 % of u.
  std::size_t draws = 100'000;
};

// Where the body's centre is when it touches, how it lands and flies. The angle
// that spin adds in flight is included. Absent where the body does not leave
// the muzzle, or would start in the ground.
ContactPrediction Predict(const Description& rig, const Setting& setting,
                          const PredictOptions& options,
                          std::mt19937_64& engine);

// H alone, of all springs together: measured, or Eq. (11).
Predicted PredictStiffness(const Description& rig,
                           const PredictOptions& options,
                           std::mt19937_64& engine);

// Height of the body's centre at touchdown: half a diameter; or by Land, for a
// rectangle whose long side stands at `face_angle_rad`; 0 without a body.
double CentreHeightAtTouchdown(const Description& rig, double face_angle_rad);

}  // namespace touchdown::rig
