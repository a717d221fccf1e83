// The ejector's springs: `count` equal helical compression springs of round
// wire, side by side (the paper's "parallel-double spring" has two).
//
// References: the paper, Eq. (11); Shigley's Mechanical Engineering Design
// (Budynas & Nisbett), chapter 10; A. M. Wahl, Mechanical Springs, 1944.
// Every function throws std::invalid_argument, naming field, value and allowed
// range, where an argument is not finite or not positive, where the coil is not
// wider than its wire, or where total_coils < active_coils.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "touchdown/rig/finding.h"

namespace touchdown::rig {

// Which diameter of the coil a number is. The paper prints D_2 and calls it
// "outer"; the formula needs the mean (Chinese practice: D_2 is the mean). A
// caliper shows outer or inner: mean = outer - wire = inner + wire.
enum class CoilDiameter { kMean, kOuter, kInner };

std::string_view Name(CoilDiameter kind);
std::optional<CoilDiameter> ParseCoilDiameter(std::string_view word);

struct Spring {
  double shear_modulus_pa = 0.0;  // G of the wire; steels: 77e9 .. 80e9
  double wire_diameter_m = 0.0;   // d
  double coil_diameter_m = 0.0;   // of the kind below
  CoilDiameter coil_diameter = CoilDiameter::kMean;
  double active_coils = 0.0;          // n
  double total_coils = 0.0;           // n_t >= n; closed ends: n + 2
  int count = 2;                      // springs side by side
  double density_kg_per_m3 = 7850.0;  // of the wire; spring steel
};

// D_m, the diameter of the helix through the wire's centre, m.
double MeanDiameter(const Spring& spring);

// H_1 = G d^4 / (8 n D_m^3), of one spring, N/m.
double StiffnessOfOne(const Spring& spring);

// H = count * H_1, N/m: the paper's Eq. (11), with the mean diameter.
double Stiffness(const Spring& spring);

// Eq. (11) read literally, with the outer diameter in the place of the mean,
// N/m. Too small by (D_m / D_o)^3; for comparison with the paper only.
double StiffnessAsPrinted(const Spring& spring);

// C = D_m / d.
double SpringIndex(const Spring& spring);

// Wahl's factor for curvature and direct shear, (4C-1)/(4C-4) + 0.615/C, C > 1.
double WahlFactor(double index);

// Coil on coil: n_t d, m (ends squared and ground).
double SolidLength(const Spring& spring);

// Mass of the wire of all springs, kg: count rho (pi d^2/4) (pi D_m n_t).
double SpringMass(const Spring& spring);

// First surge frequency of one spring between fixed ends, sqrt(H_1/m_1)/2, Hz.
double SurgeFrequency(const Spring& spring);

// What the springs are checked against. A limit that is not given is not
// checked, and a warning says so.
struct SpringLimits {
  std::optional<double> free_length_m;       // L0, of one spring
  std::optional<double> allowable_shear_pa;  // e.g. 0.45 of tensile strength

  // Least clearance left before the coils touch, as a share of the whole
  // compression. Below it pitch errors close coils early and the stiffness
  // rises. 0.15: Shigley, the fractional overrun to closure.
  double clearance_share_min = 0.15;

  // Shigley's range of the spring index: below 4 hard to coil, above 12
  // tangles.
  double index_min = 4.0;
  double index_max = 12.0;

  // L0 / D_m above which a steel spring between flat parallel ends may buckle
  // (Shigley: L0 < 2.63 D_m / alpha with alpha = 0.5). A guide rod cures it.
  double slenderness_max = 5.26;
};

struct SpringReport {
  double mean_diameter_m = 0.0;
  double index = 0.0;
  double wahl_factor = 0.0;
  double stiffness_of_one_n_per_m = 0.0;
  double stiffness_n_per_m = 0.0;
  double stiffness_as_printed_n_per_m = 0.0;
  double force_of_one_n = 0.0;  // at the given compression
  // Greatest shear stress in the wire: K 8 F D_m / (pi d^3), F = H_1 * the
  // compression; static, no fatigue.
  double max_shear_pa = 0.0;          // with Wahl's factor K
  double uncorrected_shear_pa = 0.0;  // with K = 1
  double solid_length_m = 0.0;
  double mass_kg = 0.0;  // of all springs
  double surge_hz = 0.0;
  std::optional<double> clearance_m;      // L0 - compression - solid length
  std::optional<double> clearance_share;  // of the compression; absent at 0
  std::optional<double> slenderness;      // L0 / D_m
  std::vector<Finding> findings;
};

// Everything above at `compression_m` >= 0 from free length (preload included),
// with refusals (coil bind, too little clearance, stress) and warnings (index,
// buckling, what was not checked).
SpringReport CheckSpring(const Spring& spring, double compression_m,
                         const SpringLimits& limits = {});

}  // namespace touchdown::rig
