#include "touchdown/rig/launch.h"

#include <fmt/format.h>

#include <cmath>

#include "angles.h"
#include "touchdown/core/require.h"

namespace touchdown::rig {
namespace {

void ValidateLaunch(const Launch& launch) {
  core::RequirePositive("stiffness_n_per_m", launch.stiffness_n_per_m);
  core::RequirePositive("mass_kg", launch.mass_kg);
  core::RequireNotNegative("spring_mass_kg", launch.spring_mass_kg);
  core::RequireNotNegative("preload_m", launch.preload_m);
  core::RequirePositive("efficiency", launch.efficiency);
  core::RequireNotNegative("barrel_friction", launch.barrel_friction);
  core::RequireNotNegative("loss_j", launch.loss_j);
  core::RequireNotNegative("gravity_mps2", launch.gravity_mps2);
  if (!(std::abs(launch.elevation_rad) <= kQuarterTurn * (1.0 + 1e-12))) {
    core::Refuse("elevation_rad", launch.elevation_rad, "within -pi/2 .. pi/2");
  }
}

double MovingMass(const Launch& launch) {
  return launch.mass_kg + launch.spring_mass_kg / 3.0;
}

// Work per metre of travel against gravity, N.
double GravityForce(const Launch& launch) {
  return (launch.mass_kg + launch.spring_mass_kg / 2.0) * launch.gravity_mps2 *
         std::sin(launch.elevation_rad);
}

double FrictionForce(const Launch& launch) {
  return launch.barrel_friction * launch.mass_kg * launch.gravity_mps2 *
         std::cos(launch.elevation_rad);
}

}  // namespace

double IdealLaunchSpeed(double compression_m, double stiffness_n_per_m,
                        double mass_kg) {
  core::RequireNotNegative("compression_m", compression_m);
  core::RequirePositive("stiffness_n_per_m", stiffness_n_per_m);
  core::RequirePositive("mass_kg", mass_kg);
  return compression_m * std::sqrt(stiffness_n_per_m / mass_kg);
}

core::Expected<Muzzle> LaunchSpeed(const Launch& launch, double compression_m) {
  ValidateLaunch(launch);
  core::RequireNotNegative("compression_m", compression_m);
  const double x = compression_m;
  Muzzle muzzle;
  EnergyBalance& energy = muzzle.energy;
  // (X0+X)^2 - X0^2 without the difference of squares.
  energy.spring_j =
      0.5 * launch.stiffness_n_per_m * x * (x + 2.0 * launch.preload_m);
  energy.losses_j = (1.0 - launch.efficiency) * energy.spring_j + launch.loss_j;
  energy.gravity_j = GravityForce(launch) * x;
  energy.friction_j = FrictionForce(launch) * x;
  const double useful_j = launch.efficiency * energy.spring_j;
  const double left_j =
      useful_j - launch.loss_j - energy.gravity_j - energy.friction_j;
  if (!(left_j > 0.0)) {
    return core::AbsentBecause(fmt::format(
        "does not leave the muzzle: at a compression of {:.4g} mm the springs "
        "give {:.4g} J, but gravity takes {:.4g} J, friction {:.4g} J and "
        "losses {:.4g} J; compress by more than {:.4g} mm",
        x * 1e3, energy.spring_j, energy.gravity_j, energy.friction_j,
        energy.losses_j, SolveCompression(launch, 0.0) * 1e3));
  }
  muzzle.speed_mps = std::sqrt(2.0 * left_j / MovingMass(launch));
  const double v2 = muzzle.speed_mps * muzzle.speed_mps;
  energy.body_j = 0.5 * launch.mass_kg * v2;
  energy.spring_motion_j = launch.spring_mass_kg * v2 / 6.0;
  muzzle.cancellation = (useful_j + launch.loss_j + std::abs(energy.gravity_j) +
                         energy.friction_j) /
                        left_j;
  if (muzzle.cancellation > kCancellationWarning) {
    muzzle.findings.push_back(
        {Severity::kWarning,
         fmt::format("barely leaves the muzzle: {:.3g} J remain of {:.3g} J; 1 "
                     "% in the stiffness is about {:.2g} % in the speed",
                     left_j, useful_j, 0.5 * useful_j / left_j)});
  }
  if (launch.spring_mass_kg > launch.mass_kg) {
    muzzle.findings.push_back(
        {Severity::kWarning,
         fmt::format("the springs ({:.3g} g) outweigh the body ({:.3g} g): the "
                     "share m_s/3 is an approximation, calibrate the "
                     "efficiency from measured speeds",
                     launch.spring_mass_kg * 1e3, launch.mass_kg * 1e3)});
  }
  if (launch.efficiency > 1.0) {
    muzzle.findings.push_back(
        {Severity::kWarning,
         fmt::format("efficiency {:.4g} is above 1: stiffness, mass or the "
                     "speeds it was calibrated with are wrong",
                     launch.efficiency)});
  }
  return muzzle;
}

double SolveCompression(const Launch& launch, double speed_mps) {
  ValidateLaunch(launch);
  core::RequireNotNegative("speed_mps", speed_mps);
  // a X^2 + 2 b X - c = 0 with a, c >= 0: of the two forms of the positive root
  // we take the one that does not subtract.
  const double a = launch.efficiency * launch.stiffness_n_per_m;
  const double b =
      a * launch.preload_m - GravityForce(launch) - FrictionForce(launch);
  const double c =
      MovingMass(launch) * speed_mps * speed_mps + 2.0 * launch.loss_j;
  const double root = std::sqrt(b * b + a * c);
  if (b < 0.0) return (root - b) / a;
  return root + b > 0.0 ? c / (root + b) : 0.0;
}

}  // namespace touchdown::rig
