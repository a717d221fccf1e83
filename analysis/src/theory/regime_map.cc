#include "touchdown/analysis/theory/regime_map.h"

#include <fmt/core.h>

#include <stdexcept>

#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

std::vector<double> Steps(double last, int points) {
  std::vector<double> out;
  out.reserve(static_cast<std::size_t>(points));
  for (int i = 0; i < points; ++i) out.push_back(last * i / (points - 1));
  return out;
}

void RequirePoints(const char* field, int points) {
  constexpr int kMost = 20'000;  // squared: what fits into memory
  if (points < 2 || points > kMost) {
    throw std::invalid_argument(
        fmt::format("{} is {}, must be from 2 to {}", field, points, kMost));
  }
}

}  // namespace

RegimeMap ComputeRegimeMap(const RegimeMapOptions& options) {
  RequirePoints("number of angles", options.alpha_points);
  RequirePoints("number of points on the second axis", options.axis_points);
  core::RequirePositive("largest alpha", options.alpha_max_rad, "rad");
  core::RequirePositive("end of the second axis", options.axis_max);
  ContactProblem p = options.problem;
  if (p.slip == Slip::kNone) {
    throw std::invalid_argument(
        "slip is none, must be leading or trailing for a map");
  }
  static_cast<void>(SolveContact(p));  // checks the other arguments

  RegimeMap map;
  map.axis = options.axis;
  map.problem = options.problem;
  map.alpha_rad = Steps(options.alpha_max_rad, options.alpha_points);
  map.axis_value = Steps(options.axis_max, options.axis_points);
  std::vector<SinCos> directions;
  directions.reserve(map.alpha_rad.size());
  for (const double alpha : map.alpha_rad) {
    directions.push_back(RoundedSinCosOfRadians(alpha));
  }
  map.cells.resize(map.alpha_rad.size() * map.axis_value.size());
  std::size_t cell = 0;
  for (const double value : map.axis_value) {
    (options.axis == MapAxis::kMu ? p.mu : p.omega_rad_per_s) = value;
    for (const SinCos& direction : directions) {
      p.alpha = direction;
      map.cells[cell++] = SolveSlidingContact(p);
    }
  }
  return map;
}

std::vector<ComplementarityLine> ComplementarityLines(
    const ContactProblem& problem, const std::vector<double>& alphas_rad) {
  core::RequirePositive("gravity", problem.gravity_mps2, "m/s^2");
  std::vector<ComplementarityLine> out;
  for (const double alpha : alphas_rad) {
    ContactProblem p = problem;
    p.alpha = SinCosOfRadians(alpha);
    const ContactResult r = SolveContact(p);
    out.push_back({alpha, r.a_hat, r.b_mps2 / p.gravity_mps2, r.regime});
  }
  return out;
}

}  // namespace touchdown::analysis
