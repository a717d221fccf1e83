// One row of the case file becomes a Case, and each Add...() appends some
// columns of the answer. The columns are named as in the reference cases, so
// that the two files can be compared cell by cell.
#include "app/cli/rig/rig_cases.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "app/cli/case_file.h"
#include "app/text/text.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/flight.h"
#include "touchdown/rig/launch.h"
#include "touchdown/rig/spring.h"
#include "touchdown/rig/uncertainty.h"

namespace touchdown::cli {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Each pair is the name of a column and the text of its cell.
using Cells = std::vector<std::pair<std::string_view, std::string>>;

// Holds one rig, in SI: springs, launch, relative uncertainties of their
// values, the compression beyond the preload, and the fall from muzzle to
// ground.
struct Case {
  rig::Spring spring;
  rig::SpringLimits limits;
  rig::Launch launch;
  rig::IdealRelativeU u;
  double compression_m = 0.0;
  double drop_m = 0.0;
};

// Reads the columns of a row. Throws core::InputError for a cell that is no
// number, std::invalid_argument for a number that no rig has.
Case ReadCase(const CaseRow& row) {
  const auto number = [&](std::string_view column) {
    return row.Number(column);
  };
  Case c;
  c.spring.shear_modulus_pa = number("G");
  c.spring.wire_diameter_m = number("d");
  c.spring.coil_diameter_m = number("D_outer");
  c.spring.coil_diameter = rig::CoilDiameter::kOuter;
  c.spring.active_coils = number("n_active");
  c.spring.total_coils = number("n_total");
  c.spring.density_kg_per_m3 = number("rho_spring");
  const double count = number("n_springs");
  // The count becomes an int: a larger one is a mistake of the file.
  constexpr double kMost = 1000.0;
  if (!(count >= 1.0 && count <= kMost) || count != std::floor(count)) {
    throw std::invalid_argument(fmt::format(
        "n_springs is {:g}, must be a whole number within 1 .. {:g}", count,
        kMost));
  }
  c.spring.count = static_cast<int>(count);
  c.limits.free_length_m = row.OptionalNumber("L0_m");
  c.compression_m = number("X");
  c.drop_m = number("h0");
  // Eq. (11) with the mean diameter: the cases have no measured stiffness.
  c.launch.stiffness_n_per_m = rig::Stiffness(c.spring);
  c.launch.spring_mass_kg = rig::SpringMass(c.spring);
  c.launch.mass_kg = number("m");
  c.launch.preload_m = number("preload_X0");
  c.launch.elevation_rad = number("theta_deg") * core::kDegree;
  c.launch.efficiency = number("eta");
  c.launch.barrel_friction = number("mu_barrel");
  c.launch.gravity_mps2 = number("g");
  c.u.shear_modulus = number("urel_G");
  c.u.wire_diameter = number("urel_d");
  c.u.active_coils = number("urel_n");
  c.u.coil_diameter = number("urel_D");
  c.u.compression = number("urel_X");
  c.u.mass = number("urel_m");
  return c;
}

// 17 digits give back the same double; what does not exist is "nan".
void AddNumber(Cells& cells, std::string_view name, double value) {
  cells.emplace_back(name,
                     std::isnan(value) ? "nan" : fmt::format("{:.17g}", value));
}

// Returns the speed at the muzzle, or NaN where the body does not leave it.
double SpeedOrNan(const rig::Launch& launch, double compression_m) {
  const auto muzzle = rig::LaunchSpeed(launch, compression_m);
  return muzzle ? muzzle->speed_mps : kNan;
}

// Adds the stiffness by both readings of Eq. (11), stresses at the whole
// compression, clearance, mass and energy.
void AddSpring(const Case& c, const rig::SpringReport& report, Cells& cells) {
  // whole_m counts from the free length: the springs are compressed by the
  // preload already.
  const double whole_m = c.launch.preload_m + c.compression_m;
  AddNumber(cells, "H_outer_literal", report.stiffness_as_printed_n_per_m);
  AddNumber(cells, "H_mean", report.stiffness_n_per_m);
  AddNumber(cells, "ratio_H",
            report.stiffness_n_per_m / report.stiffness_as_printed_n_per_m);
  AddNumber(cells, "spring_index_C", report.index);
  AddNumber(cells, "Wahl_Kw", report.wahl_factor);
  AddNumber(cells, "F_per_spring_N", report.force_of_one_n);
  AddNumber(cells, "tau_max_Pa", report.max_shear_pa);
  AddNumber(cells, "tau_uncorrected_Pa", report.uncorrected_shear_pa);
  AddNumber(cells, "solid_length_m", report.solid_length_m);
  if (c.limits.free_length_m) {
    AddNumber(cells, "L0_m", *c.limits.free_length_m);
    AddNumber(cells, "coil_clearance_left_m",
              *c.limits.free_length_m - whole_m - report.solid_length_m);
  } else {
    cells.emplace_back("L0_m", "");
    cells.emplace_back("coil_clearance_left_m", "");
  }
  AddNumber(cells, "spring_mass_total_kg", report.mass_kg);
  AddNumber(cells, "surge_freq_Hz", report.surge_hz);
  AddNumber(cells, "spring_energy_J",
            0.5 * report.stiffness_n_per_m * c.compression_m *
                (c.compression_m + 2.0 * c.launch.preload_m));
}

// Adds the launch speed by Eq. (10) and by the energy balance, and the flight
// from the muzzle to the ground.
void AddLaunch(const Case& c, const rig::SpringReport& report, Cells& cells) {
  const double x = c.compression_m;
  AddNumber(cells, "v_eq10_outer",
            rig::IdealLaunchSpeed(x, report.stiffness_as_printed_n_per_m,
                                  c.launch.mass_kg));
  AddNumber(
      cells, "v_eq10_mean",
      rig::IdealLaunchSpeed(x, report.stiffness_n_per_m, c.launch.mass_kg));
  // The first two columns have one correction of Eq. (10) each, beside the
  // preload; v_full has all.
  rig::Launch one;
  one.stiffness_n_per_m = c.launch.stiffness_n_per_m;
  one.mass_kg = c.launch.mass_kg;
  one.preload_m = c.launch.preload_m;
  one.elevation_rad = c.launch.elevation_rad;
  one.gravity_mps2 = c.launch.gravity_mps2;
  AddNumber(cells, "v_gravity", SpeedOrNan(one, x));
  one.gravity_mps2 = 0.0;
  one.spring_mass_kg = c.launch.spring_mass_kg;
  AddNumber(cells, "v_spring_mass", SpeedOrNan(one, x));
  const double speed = SpeedOrNan(c.launch, x);
  AddNumber(cells, "v_full", speed);
  // A body that does not leave the muzzle has no flight: all columns are NaN.
  rig::Flight flight{kNan, kNan, kNan, kNan, kNan, kNan};
  if (!std::isnan(speed)) {
    flight = rig::Fly(speed, c.launch.elevation_rad, c.drop_m,
                      c.launch.gravity_mps2);
  }
  AddNumber(cells, "impact_speed", flight.impact_speed_mps);
  AddNumber(cells, "impact_angle_deg",
            flight.approach_angle_rad / core::kDegree);
  AddNumber(cells, "flight_time", flight.time_s);
  AddNumber(cells, "range", flight.range_m);
}

// Adds the relative u of the ideal launch speed three times: to first order
// with the mean diameter, as the paper prints it, and by Monte Carlo.
void AddUncertainty(const Case& c, const RigCasesOptions& options,
                    Cells& cells) {
  const rig::IdealSpeedU gum = rig::IdealSpeedUncertainty(c.spring, c.u);
  AddNumber(cells, "u_rel_GUM_mean", gum.u_rel);
  AddNumber(cells, "u_rel_GUM_outer", rig::PrintedSpeedUncertainty(c.u).u_rel);
  AddNumber(cells, "bias_rel_2nd_order", gum.bias_rel);
  // Each row has a generator of its own, so that a row gives the same answer in
  // any file.
  std::mt19937_64 engine(options.seed);
  const rig::MonteCarloRun run =
      rig::IdealSpeedMonteCarlo(c.spring, c.u, options.draws, engine);
  rig::MonteCarlo mc{kNan, kNan, kNan, {kNan, kNan}};
  if (!run.outputs.empty()) mc = run.outputs.front();
  AddNumber(cells, "MC_mean_over_v", mc.mean);
  AddNumber(cells, "MC_u_rel", mc.u);
  AddNumber(cells, "MC_se_of_u", mc.u_of_u);
  AddNumber(cells, "MC_q2.5_over_v", mc.interval95.low);
  AddNumber(cells, "MC_q97.5_over_v", mc.interval95.high);
}

// Adds whether the body leaves the muzzle, whether the springs bear it, and
// every warning in one cell.
void AddFindings(const Case& c, const rig::SpringReport& report, Cells& cells) {
  std::vector<rig::Finding> findings = report.findings;
  const auto muzzle = rig::LaunchSpeed(c.launch, c.compression_m);
  cells.emplace_back("leaves_muzzle", muzzle ? "yes" : "no");
  cells.emplace_back("allowed", rig::Allowed(findings) ? "yes" : "no");
  if (muzzle) {
    findings.insert(findings.end(), muzzle->findings.begin(),
                    muzzle->findings.end());
  } else {
    findings.push_back({rig::Severity::kRefusal, muzzle.error().reason});
  }
  std::string text;
  for (const rig::Finding& finding : findings) {
    text += text.empty() ? "" : "; ";
    text += finding.what;
  }
  cells.emplace_back("findings", report::CsvCell(text));
}

// Returns all columns of the answer to one row, in the order of the result.
Cells Evaluate(const CaseRow& row, const RigCasesOptions& options) {
  const Case c = ReadCase(row);
  const rig::SpringReport report = rig::CheckSpring(
      c.spring, c.launch.preload_m + c.compression_m, c.limits);
  Cells cells;
  cells.emplace_back("id", report::CsvCell(row.Text("id")));
  AddSpring(c, report, cells);
  AddLaunch(c, report, cells);
  AddUncertainty(c, options, cells);
  AddFindings(c, report, cells);
  return cells;
}

}  // namespace

std::string RigCases(const std::string& path, const RigCasesOptions& options) {
  const CaseTable table = ReadCases(path, {});
  std::string out;
  for (const CaseRow& row : table.rows) {
    Cells cells;
    row.Answer([&] { cells = Evaluate(row, options); });
    // The header follows from the first answer: all rows have the same columns.
    if (out.empty()) {
      for (const auto& [name, text] : cells) {
        out += fmt::format("{}{}", out.empty() ? "" : ",", name);
      }
      out += '\n';
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      out += fmt::format("{}{}", i == 0 ? "" : ",", cells[i].second);
    }
    out += '\n';
  }
  return out;
}

}  // namespace touchdown::cli
