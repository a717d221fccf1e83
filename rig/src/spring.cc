#include "touchdown/rig/spring.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "touchdown/core/require.h"

namespace touchdown::rig {
namespace {

using std::numbers::pi;

void ValidateSpring(const Spring& spring) {
  core::RequirePositive("shear_modulus_pa", spring.shear_modulus_pa);
  core::RequirePositive("wire_diameter_m", spring.wire_diameter_m);
  core::RequirePositive("coil_diameter_m", spring.coil_diameter_m);
  core::RequirePositive("active_coils", spring.active_coils);
  core::RequirePositive("density_kg_per_m3", spring.density_kg_per_m3);
  if (!(spring.total_coils >= spring.active_coils) ||
      !std::isfinite(spring.total_coils)) {
    core::Refuse("total_coils", spring.total_coils,
                 "at least active_coils and finite");
  }
  if (spring.count < 1) core::Refuse("count", spring.count, "at least 1");
}

double MeanCoilDiameter(const Spring& spring) {
  switch (spring.coil_diameter) {
    case CoilDiameter::kOuter:
      return spring.coil_diameter_m - spring.wire_diameter_m;
    case CoilDiameter::kInner:
      return spring.coil_diameter_m + spring.wire_diameter_m;
    case CoilDiameter::kMean:
      break;
  }
  return spring.coil_diameter_m;
}

// G d^4 / (8 n D^3) for whichever D.
double Eq11OfOne(const Spring& spring, double diameter_m) {
  const double d = spring.wire_diameter_m;
  const double ratio = d / diameter_m;
  return spring.shear_modulus_pa * d * ratio * ratio * ratio /
         (8.0 * spring.active_coils);
}

double UncorrectedShear(const Spring& spring, double compression_m) {
  const double d = spring.wire_diameter_m;
  const double force_n = StiffnessOfOne(spring) * compression_m;
  return 8.0 * force_n * MeanDiameter(spring) / (pi * d * d * d);
}

void Add(std::vector<Finding>& to, Severity severity, std::string what) {
  to.push_back({severity, std::move(what)});
}

void CheckClearance(const SpringLimits& limits, double compression_m,
                    SpringReport& report) {
  if (!limits.free_length_m) {
    Add(report.findings, Severity::kWarning,
        "coil clearance and buckling not checked: no free length given");
    return;
  }
  core::RequirePositive("free_length_m", *limits.free_length_m);
  const double clearance =
      *limits.free_length_m - compression_m - report.solid_length_m;
  report.clearance_m = clearance;
  if (compression_m > 0.0) report.clearance_share = clearance / compression_m;
  if (clearance < 0.0) {
    Add(report.findings, Severity::kRefusal,
        fmt::format("coil bind: the coils touch {:.3g} mm before the "
                    "compression of {:.4g} mm is reached (free length {:.4g} "
                    "mm, solid length {:.4g} mm)",
                    -clearance * 1e3, compression_m * 1e3,
                    *limits.free_length_m * 1e3, report.solid_length_m * 1e3));
  } else if (clearance < limits.clearance_share_min * compression_m) {
    Add(report.findings, Severity::kRefusal,
        fmt::format("coil clearance of {:.3g} mm is {:.1f} % of the "
                    "compression, at least {:.0f} % is needed",
                    clearance * 1e3, 100.0 * clearance / compression_m,
                    100.0 * limits.clearance_share_min));
  }
  report.slenderness = *limits.free_length_m / report.mean_diameter_m;
  if (*report.slenderness > limits.slenderness_max) {
    Add(report.findings, Severity::kWarning,
        fmt::format("may buckle without a guide rod: free length is {:.2f} "
                    "mean diameters, above {:.2f}",
                    *report.slenderness, limits.slenderness_max));
  }
}

void CheckStress(const SpringLimits& limits, SpringReport& report) {
  if (!limits.allowable_shear_pa) {
    Add(report.findings, Severity::kWarning,
        "stress not checked: no allowable shear stress given");
    return;
  }
  core::RequirePositive("allowable_shear_pa", *limits.allowable_shear_pa);
  if (report.max_shear_pa > *limits.allowable_shear_pa) {
    Add(report.findings, Severity::kRefusal,
        fmt::format("shear stress of {:.4g} MPa exceeds the allowable {:.4g} "
                    "MPa: the spring would set",
                    report.max_shear_pa * 1e-6,
                    *limits.allowable_shear_pa * 1e-6));
  }
}

}  // namespace

std::string_view Name(CoilDiameter kind) {
  switch (kind) {
    case CoilDiameter::kOuter:
      return "outer";
    case CoilDiameter::kInner:
      return "inner";
    case CoilDiameter::kMean:
      break;
  }
  return "mean";
}

std::optional<CoilDiameter> ParseCoilDiameter(std::string_view word) {
  for (const CoilDiameter kind :
       {CoilDiameter::kMean, CoilDiameter::kOuter, CoilDiameter::kInner}) {
    if (word == Name(kind)) return kind;
  }
  return std::nullopt;
}

double MeanDiameter(const Spring& spring) {
  ValidateSpring(spring);
  const double mean = MeanCoilDiameter(spring);
  // At index 1 the hole closes: no such coil can be wound.
  if (!(mean > spring.wire_diameter_m)) {
    core::Refuse("mean coil diameter in m", mean,
                 "greater than the wire diameter");
  }
  return mean;
}

double StiffnessOfOne(const Spring& spring) {
  return Eq11OfOne(spring, MeanDiameter(spring));
}

double Stiffness(const Spring& spring) {
  return spring.count * StiffnessOfOne(spring);
}

double StiffnessAsPrinted(const Spring& spring) {
  const double outer = MeanDiameter(spring) + spring.wire_diameter_m;
  return spring.count *
         Eq11OfOne(spring, spring.coil_diameter == CoilDiameter::kOuter
                               ? spring.coil_diameter_m
                               : outer);
}

double SpringIndex(const Spring& spring) {
  return MeanDiameter(spring) / spring.wire_diameter_m;
}

double WahlFactor(double index) {
  if (!(index > 1.0) || !std::isfinite(index)) {
    core::Refuse("spring index", index, "greater than 1 and finite");
  }
  return (4.0 * index - 1.0) / (4.0 * index - 4.0) + 0.615 / index;
}

double SolidLength(const Spring& spring) {
  ValidateSpring(spring);
  return spring.total_coils * spring.wire_diameter_m;
}

double SpringMass(const Spring& spring) {
  const double d = spring.wire_diameter_m;
  const double wire_length = pi * MeanDiameter(spring) * spring.total_coils;
  return spring.count * spring.density_kg_per_m3 * (pi * d * d / 4.0) *
         wire_length;
}

double SurgeFrequency(const Spring& spring) {
  const double mass_of_one = SpringMass(spring) / spring.count;
  return 0.5 * std::sqrt(StiffnessOfOne(spring) / mass_of_one);
}

SpringReport CheckSpring(const Spring& spring, double compression_m,
                         const SpringLimits& limits) {
  core::RequireNotNegative("compression_m", compression_m);
  SpringReport report;
  report.mean_diameter_m = MeanDiameter(spring);
  report.index = SpringIndex(spring);
  report.wahl_factor = WahlFactor(report.index);
  report.stiffness_of_one_n_per_m = StiffnessOfOne(spring);
  report.stiffness_n_per_m = Stiffness(spring);
  report.stiffness_as_printed_n_per_m = StiffnessAsPrinted(spring);
  report.force_of_one_n = report.stiffness_of_one_n_per_m * compression_m;
  report.uncorrected_shear_pa = UncorrectedShear(spring, compression_m);
  report.max_shear_pa = report.wahl_factor * report.uncorrected_shear_pa;
  report.solid_length_m = SolidLength(spring);
  report.mass_kg = SpringMass(spring);
  report.surge_hz = SurgeFrequency(spring);
  CheckClearance(limits, compression_m, report);
  CheckStress(limits, report);
  if (report.index < limits.index_min || report.index > limits.index_max) {
    Add(report.findings, Severity::kWarning,
        fmt::format("spring index {:.3g} is outside {:g} .. {:g}: hard to wind "
                    "true, Eq. (11) is less exact",
                    report.index, limits.index_min, limits.index_max));
  }
  return report;
}

}  // namespace touchdown::rig
