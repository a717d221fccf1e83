#include "touchdown/rig/description.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "touchdown/core/require.h"

namespace touchdown::rig {

core::Expected<Spring> MakeSpring(const Springs& springs) {
  if (!springs.geometry) {
    return core::AbsentBecause("the springs' geometry is not given");
  }
  const SpringGeometry& g = *springs.geometry;
  Spring spring;
  spring.shear_modulus_pa = g.shear_modulus_pa.value;
  spring.wire_diameter_m = g.wire_diameter_m.value;
  spring.coil_diameter_m = g.coil_diameter_m.value;
  spring.coil_diameter = g.coil_diameter;
  spring.active_coils = g.active_coils.value;
  spring.total_coils = g.total_coils;
  spring.count = springs.count;
  spring.density_kg_per_m3 = g.density_kg_per_m3;
  return spring;
}

Launch MakeLaunch(const Description& rig, double elevation_rad) {
  const auto spring = MakeSpring(rig.springs);
  if (!spring && !rig.springs.stiffness_n_per_m) {
    throw std::invalid_argument(
        "springs: neither geometry nor stiffness is given");
  }
  Launch launch;
  launch.stiffness_n_per_m = rig.springs.stiffness_n_per_m
                                 ? rig.springs.stiffness_n_per_m->value
                                 : Stiffness(*spring);
  launch.spring_mass_kg = rig.springs.mass_kg ? rig.springs.mass_kg->value
                          : spring            ? SpringMass(*spring)
                                              : 0.0;
  launch.mass_kg = rig.mass_kg.value;
  launch.preload_m = rig.preload_m.value;
  launch.elevation_rad = elevation_rad;
  launch.efficiency = rig.efficiency.value;
  launch.barrel_friction = rig.barrel_friction.value;
  launch.loss_j = rig.loss_j.value;
  launch.gravity_mps2 = rig.gravity_mps2.value;
  return launch;
}

std::vector<Finding> CheckCompression(const Description& rig,
                                      double compression_m) {
  std::vector<Finding> findings;
  if (rig.compression_max_m && compression_m > *rig.compression_max_m) {
    findings.push_back(
        {Severity::kRefusal,
         fmt::format("a compression of {:.4g} mm is needed, the trigger's "
                     "travel ends at {:.4g} mm",
                     compression_m * 1e3, *rig.compression_max_m * 1e3)});
  }
  const double whole_m = compression_m + rig.preload_m.value;
  const auto spring = MakeSpring(rig.springs);
  if (!spring) {
    findings.push_back(
        {Severity::kWarning,
         "coil clearance and stress not checked: " + spring.error().reason});
    return findings;
  }
  SpringLimits limits;
  limits.free_length_m = rig.springs.free_length_m;
  limits.allowable_shear_pa = rig.springs.allowable_shear_pa;
  std::vector<Finding> more = CheckSpring(*spring, whole_m, limits).findings;
  findings.insert(findings.end(), more.begin(), more.end());
  if (rig.springs.stiffness_n_per_m) {
    // A measured stiffness and a geometry that disagree: one of them is wrong,
    // often the kind of the coil diameter (E22: up to (D_m/D_o)^3).
    constexpr double kDisagreement = 0.1;
    const double ratio =
        Stiffness(*spring) / rig.springs.stiffness_n_per_m->value;
    if (std::abs(ratio - 1.0) > kDisagreement) {
      findings.push_back(
          {Severity::kWarning,
           fmt::format("Eq. (11) gives {:.3g} times the measured stiffness: "
                       "check coil_diameter_kind and active_coils",
                       ratio)});
    }
  }
  return findings;
}

}  // namespace touchdown::rig
