// What the rig really does, from measurements: stiffness from forces,
// efficiency and losses from launch speeds. Linear least squares (JCGM 100,
// H.3) with the covariance of what is fitted.
//
// Where the points bear uncertainties they are the weights; the stated u is
// then enlarged by sqrt(chi^2/dof) where the points scatter more than they
// claim (Birge). Where they bear none, u comes from the scatter alone. With dof
// degrees of freedom the 95 % interval is Student's.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "touchdown/core/estimate.h"
#include "touchdown/core/expected.h"
#include "touchdown/rig/finding.h"
#include "touchdown/rig/launch.h"

namespace touchdown::rig {

struct ForcePoint {
  double compression_m = 0.0;  // from free length or from any fixed point
  core::Estimate force_n;      // of all springs together
};

struct StiffnessFit {
  core::Estimate stiffness_n_per_m;
  core::Estimate force_at_zero_n;  // intercept: preload, or a zero shift
  double correlation = 0.0;        // of the two
  double residual_n = 0.0;         // standard deviation of force about the line
  std::size_t dof = 0;
  std::vector<Finding> findings;
};

struct StiffnessFitOptions {
  // Standard uncertainty of each compression, m; it enters as H u (effective
  // variance). 0: exact.
  double u_compression_m = 0.0;
};

// F = F0 + H X. Absent where there are fewer than 3 points, the compressions
// are all equal, or the fitted stiffness is not positive. Warns of a curved
// characteristic (quadratic term beyond 3 of its u; needs 5 points): coils that
// close early or friction. Throws std::invalid_argument where a number is not
// finite, a u is negative, or only some points bear a u.
core::Expected<StiffnessFit> FitStiffness(
    std::span<const ForcePoint> points,
    const StiffnessFitOptions& options = {});

struct SpeedPoint {
  double compression_m = 0.0;  // X, travel beyond the preload; > 0
  core::Estimate speed_mps;    // at the muzzle; > 0
};

// What besides the efficiency is fitted.
enum class LossModel {
  kNone,      // v^2 = s z: 1 unknown
  kPerShot,   // v^2 = s z - 2 E_loss/M: the intercept
  kFriction,  // v^2 = s z - 2 mu_b m g cos(theta) X/M
};

struct EfficiencyFit {
  core::Estimate efficiency;  // eta; u includes those of H and M below
  // eta H, what the speeds really determine: predict with it as stiffness and
  // efficiency 1, and the error of H drops out.
  core::Estimate effective_stiffness_n_per_m;
  core::Estimate loss_j;            // 0 +- 0 unless kPerShot
  core::Estimate barrel_friction;   // 0 +- 0 unless kFriction
  double slope_per_s2 = 0.0;        // s = eta H/(m + m_s/3)
  double residual_m2_per_s2 = 0.0;  // standard deviation of v^2 about the fit
  std::size_t dof = 0;
  std::vector<Finding> findings;
};

struct EfficiencyFitOptions {
  LossModel losses = LossModel::kPerShot;
  double u_stiffness_rel = 0.0;  // u(H)/H
  double u_mass_rel = 0.0;       // u(M)/M of the moving mass
};

// Regression of v^2 + (work against gravity) on z = (X0+X)^2 - X0^2, which is
// X^2 without preload. `launch` gives H, masses, preload, elevation, gravity;
// its efficiency, friction and loss are ignored. Absent where points are fewer
// than unknowns + 1 or all alike, or eta is not positive; a loss that comes out
// negative stands, with a warning. Throws like FitStiffness and LaunchSpeed.
core::Expected<EfficiencyFit> FitEfficiency(
    std::span<const SpeedPoint> points, const Launch& launch,
    const EfficiencyFitOptions& options = {});

// 0.975 quantile of Student's t, `dof` >= 1; relative error below 1e-4 from
// dof 3 on (G. W. Hill, CACM Algorithm 396, 1970), exact for 1 and 2.
double StudentT975(std::size_t dof);

}  // namespace touchdown::rig
