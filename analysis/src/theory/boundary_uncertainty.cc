#include "theory/boundary_uncertainty.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "touchdown/core/require.h"

namespace touchdown::analysis {
namespace {

// The inputs that can carry an uncertainty, and where they may lie.
struct Uncertain {
  const char* name;
  core::Estimate BoundaryInputs::*field;
  double low;
  double high;
};

// Ends of ranges: above 0, and no end.
constexpr double kLeastPositive = std::numeric_limits<double>::min();
constexpr double kHuge = std::numeric_limits<double>::max();

// The inputs that may bear an uncertainty, with the ranges that a step must
// stay within.
constexpr std::array<Uncertain, 9> kUncertain = {{
    {"kappa", &BoundaryInputs::kappa, 0.0, kHuge},
    {"radius_m", &BoundaryInputs::radius_m, kLeastPositive, kHuge},
    {"mu", &BoundaryInputs::mu, 0.0, kHuge},
    {"omega_rad_per_s", &BoundaryInputs::omega_rad_per_s, -kHuge, kHuge},
    {"gravity_mps2", &BoundaryInputs::gravity_mps2, kLeastPositive, kHuge},
    {"restitution", &BoundaryInputs::restitution, 0.0, 1.0},
    {"speed_mps", &BoundaryInputs::speed_mps, kLeastPositive, kHuge},
    {"bounce_height_m", &BoundaryInputs::bounce_height_m, kLeastPositive,
     kHuge},
    {"held_angle_rad", &BoundaryInputs::held_angle_rad, 0.0,
     std::numbers::pi / 2.0},
}};

// Whether the model's boundary depends on the input at all.
bool Uses(BoundaryModel model, const BoundaryInputs& in,
          const Uncertain& what) {
  using Field = core::Estimate BoundaryInputs::*;
  const Field f = what.field;
  const bool of_spin = f == &BoundaryInputs::radius_m ||
                       f == &BoundaryInputs::omega_rad_per_s ||
                       f == &BoundaryInputs::gravity_mps2;
  const bool of_corner =
      f == &BoundaryInputs::kappa || f == &BoundaryInputs::mu;
  switch (model) {
    case BoundaryModel::kPublished:
    case BoundaryModel::kPaperReplication:
      return false;
    case BoundaryModel::kPrintedEquations:
      return of_spin;
    case BoundaryModel::kCorrectedLcp:
      return !IsSphere(in) &&
             (of_spin || (of_corner && in.slip == Slip::kLeading));
    case BoundaryModel::kDetectableBounce:
      break;
  }
  const bool of_rectangle = of_corner || f == &BoundaryInputs::radius_m ||
                            f == &BoundaryInputs::held_angle_rad;
  if (f == &BoundaryInputs::held_angle_rad && !in.held_kind) return false;
  return f != &BoundaryInputs::omega_rad_per_s &&
         !(IsSphere(in) && of_rectangle);
}

core::Expected<double> WithShift(BoundaryModel model, BoundaryInputs in,
                                 const Uncertain& what, double shift) {
  double& value = (in.*what.field).value;
  value = std::clamp(value + shift, what.low, what.high);
  return BoundaryAngle(model, in);
}

// A boundary of spin goes as the square root of w - 1, w = R omega^2/g: first
// order needs w - 1 > 10 u(w).
bool IsFarFromThreshold(BoundaryModel model, const BoundaryInputs& in,
                        double boundary_rad) {
  if (model == BoundaryModel::kDetectableBounce) return true;
  const auto spin = SpinAngle(in);
  if (!spin || *spin != boundary_rad) return true;
  const auto relative = [](const core::Estimate& e) { return e.u / e.value; };
  const double w = in.radius_m.value * in.omega_rad_per_s.value *
                   in.omega_rad_per_s.value / in.gravity_mps2.value;
  const double u_w =
      w * std::hypot(relative(in.radius_m), 2.0 * relative(in.omega_rad_per_s),
                     relative(in.gravity_mps2));
  // Standard uncertainties between w and its limit 1, where the slope is
  // infinite: nearer, first order means nothing.
  constexpr double kSafety = 10.0;
  return w - 1.0 > kSafety * u_w;
}

}  // namespace

// First order by central differences over u/10, which is as far from rounding
// as from curvature; and whether the slope survives 3 u.
void PropagateFirstOrder(BoundaryModel model, const BoundaryInputs& in,
                         BoundaryAnswer& out) {
  double variance = 0.0;
  bool valid = true;
  for (const Uncertain& what : kUncertain) {
    const double u = (in.*what.field).u;
    if (u == 0.0 || !Uses(model, in, what)) continue;
    const double step = 0.1 * u;
    const auto up = WithShift(model, in, what, step);
    const auto down = WithShift(model, in, what, -step);
    if (!up || !down) {
      valid = false;
      continue;
    }
    const double slope = (*up - *down) / (2.0 * step);
    out.sensitivities.push_back({what.name, slope, std::abs(slope) * u});
    variance += slope * u * slope * u;
    for (const double reach : {3.0 * u, -3.0 * u}) {
      const auto far = WithShift(model, in, what, reach);
      valid = valid && far &&
              std::abs(*far - *out.boundary_rad - slope * reach) <=
                  0.5 * std::abs(slope * reach);
    }
  }
  out.uncertainty.first_order_u_rad = std::sqrt(variance);
  out.uncertainty.first_order_is_valid =
      valid && IsFarFromThreshold(model, in, *out.boundary_rad);
}

void PropagateByDraws(BoundaryModel model, const BoundaryInputs& in,
                      std::mt19937_64& engine, int n_draws,
                      BoundaryUncertainty& out) {
  std::normal_distribution<double> normal;
  std::vector<double> angles;
  angles.reserve(static_cast<std::size_t>(n_draws));
  for (int i = 0; i < n_draws; ++i) {
    BoundaryInputs drawn = in;
    for (const Uncertain& what : kUncertain) {
      core::Estimate& e = drawn.*what.field;
      if (e.u == 0.0 || !Uses(model, in, what)) continue;
      // What cannot be (a negative friction) is drawn again.
      double value = 0.0;
      do {
        value = (in.*what.field).value + e.u * normal(engine);
      } while (!(value >= what.low && value <= what.high));
      e.value = value;
    }
    if (const auto angle = BoundaryAngle(model, drawn)) {
      angles.push_back(*angle);
    }
  }
  out.n_draws = n_draws;
  out.p_none = 1.0 - static_cast<double>(angles.size()) / n_draws;
  constexpr std::size_t kFew = 100;  // too few for a 2.5 % quantile
  if (angles.size() < kFew) return;
  std::sort(angles.begin(), angles.end());
  double sum = 0.0;
  for (const double a : angles) sum += a;
  const double n = static_cast<double>(angles.size());
  const double mean = sum / n;
  double square = 0.0;
  for (const double a : angles) square += (a - mean) * (a - mean);
  const auto quantile = [&](double p) {
    const double position = p * (n - 1.0);
    const auto i = static_cast<std::size_t>(position);
    const std::size_t j = std::min(i + 1, angles.size() - 1);
    return std::lerp(angles[i], angles[j], position - std::floor(position));
  };
  out.mean_rad = mean;
  out.u_rad = std::sqrt(square / (n - 1.0));
  out.low_rad = quantile(0.025);
  out.high_rad = quantile(0.975);
}

bool HasUncertainty(BoundaryModel model, const BoundaryInputs& in) {
  bool any = false;
  for (const Uncertain& what : kUncertain) {
    const double u = (in.*what.field).u;
    core::RequireNotNegative(std::string("u of ") + what.name, u);
    any = any || (u > 0.0 && Uses(model, in, what));
  }
  return any;
}

}  // namespace touchdown::analysis
