// Makes a description of the rig from rig.toml, from flags, or from the file
// with single values replaced by flags. Flags bear the unit of their name; the
// description is SI.
#include "app/cli/rig/rig_flags.h"

#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "app/cli/options.h"
#include "app/cli/values.h"
#include "touchdown/core/units.h"

namespace touchdown::cli {
namespace {

constexpr double kGram = 1e-3;  // kg
constexpr double kGiga = 1e9;
constexpr double kMega = 1e6;

// Overwrites `to` where the flag was given.
template <class To>
void TakeEstimate(To& to, const char* flag, const std::string& text,
                  double unit) {
  if (!text.empty()) to = ParseEstimate(flag, text, unit);
}

// Puts the typed geometry of the springs into `springs`. Where there is a
// geometry already, the typed values replace its own. Where there is none, all
// five must be typed, unless none is and a measured stiffness serves. Throws
// std::invalid_argument naming the first that is missing.
void TakeGeometry(const RigFlags& flags, rig::Springs& springs) {
  const bool any = !flags.shear_modulus_gpa.empty() || !flags.wire_mm.empty() ||
                   !flags.coil_mm.empty() || !flags.coil_diameter.empty() ||
                   !flags.active_coils.empty();
  if (!any && (springs.geometry || springs.stiffness_n_per_m)) return;
  // Without a geometry to correct, each value must come from a flag.
  const bool fresh = !springs.geometry;
  rig::SpringGeometry geometry =
      springs.geometry.value_or(rig::SpringGeometry{});
  if (fresh) {
    const auto need = [](const char* flag, const std::string& text) {
      if (!text.empty()) return;
      throw std::invalid_argument(
          fmt::format("{} is missing: give --rig rig.toml (`touchdown rig "
                      "example` prints one), all of --shear-modulus-gpa "
                      "--wire-mm --coil-mm --coil-diameter --active-coils, or "
                      "--stiffness-n-per-m",
                      flag));
    };
    need("--shear-modulus-gpa", flags.shear_modulus_gpa);
    need("--wire-mm", flags.wire_mm);
    need("--coil-mm", flags.coil_mm);
    need("--coil-diameter", flags.coil_diameter);
    need("--active-coils", flags.active_coils);
  }
  // The coils that do not act keep their number when the active ones change: 2
  // for closed ends (rig/spring.h), or what rig.toml implies.
  const double dead =
      fresh ? 2.0 : geometry.total_coils - geometry.active_coils.value;
  TakeEstimate(geometry.shear_modulus_pa, "--shear-modulus-gpa",
               flags.shear_modulus_gpa, kGiga);
  TakeEstimate(geometry.wire_diameter_m, "--wire-mm", flags.wire_mm,
               core::kMillimetre);
  TakeEstimate(geometry.coil_diameter_m, "--coil-mm", flags.coil_mm,
               core::kMillimetre);
  TakeEstimate(geometry.active_coils, "--active-coils", flags.active_coils,
               1.0);
  if (!flags.coil_diameter.empty()) {
    const auto kind = rig::ParseCoilDiameter(flags.coil_diameter);
    if (!kind) {
      throw std::invalid_argument(
          fmt::format("--coil-diameter is \"{}\", must be mean, outer or inner",
                      flags.coil_diameter));
    }
    geometry.coil_diameter = *kind;
  }
  // A geometry typed here is meant to be used: it replaces a stiffness measured
  // on other springs.
  if (any) springs.stiffness_n_per_m.reset();
  geometry.total_coils = geometry.active_coils.value + dead;
  springs.geometry = geometry;
}

}  // namespace

// Defaults stand in brackets in the help, "[2]": they belong to the description
// and apply only where neither flag nor file says otherwise.
Option AddSpringFlags(CLI::App& app, RigFlags& flags) {
  const Option rig =
      AddOption(app, "--rig", flags.rig,
                "rig description (`touchdown rig example` prints one); the "
                "flags below correct it. Numbers: VALUE or VALUE+-U");
  AddOption(app, "--springs", flags.count, "equal springs side by side [2]");
  AddOption(app, "--shear-modulus-gpa", flags.shear_modulus_gpa,
            "G of the wire");
  AddOption(app, "--wire-mm", flags.wire_mm, "wire diameter d");
  AddOption(app, "--coil-mm", flags.coil_mm, "coil diameter D");
  AddOption(app, "--coil-diameter", flags.coil_diameter,
            "which diameter that is: mean, outer or inner");
  AddOption(app, "--active-coils", flags.active_coils, "n");
  AddOption(app, "--total-coils", flags.total_coils, "[active + 2]");
  AddOption(app, "--density-kg-per-m3", flags.density_kg_per_m3,
            "of the wire [7850]");
  AddOption(app, "--free-length-mm", flags.free_length_mm,
            "L0, for coil clearance and buckling");
  AddOption(app, "--allowable-shear-mpa", flags.allowable_shear_mpa,
            "for the stress");
  AddOption(app, "--stiffness-n-per-m", flags.stiffness_n_per_m,
            "measured, all springs together; replaces Eq. (11)");
  AddOption(app, "--spring-mass-g", flags.spring_mass_g,
            "weighed, all springs together");
  AddOption(app, "--preload-mm", flags.preload_mm, "X0 [0]");
  return rig;
}

void AddLaunchFlags(CLI::App& app, RigFlags& flags) {
  AddOption(app, "--mass-g", flags.mass_g, "of the body");
  AddOption(app, "--efficiency", flags.efficiency, "[1]");
  AddOption(app, "--barrel-friction", flags.barrel_friction, "coefficient [0]");
  AddOption(app, "--loss-j", flags.loss_j, "energy lost in each shot [0]");
  AddOption(app, "--gravity-mps2", flags.gravity_mps2, "[9.80665+-0.015]");
  AddOption(app, "--u-compression-mm", flags.u_compression_mm,
            "standard uncertainty of the compression [0]");
  AddOption(app, "--u-elevation-deg", flags.u_elevation_deg, "[0]");
  AddOption(app, "--u-height-mm", flags.u_height_mm, "[0]");
}

rig::Description MakeDescription(const RigFlags& flags) {
  rig::Description out;
  // The file comes first, so that every flag below corrects it.
  if (!flags.rig.empty()) out = rig::ReadDescription(flags.rig);
  rig::Springs& springs = out.springs;
  const bool typed_stiffness = !flags.stiffness_n_per_m.empty();
  TakeEstimate(springs.stiffness_n_per_m, "--stiffness-n-per-m",
               flags.stiffness_n_per_m, 1.0);
  TakeGeometry(flags, springs);
  // Where both are typed, the measured one is used, as in rig.toml.
  if (typed_stiffness) {
    springs.stiffness_n_per_m =
        ParseEstimate("--stiffness-n-per-m", flags.stiffness_n_per_m, 1.0);
  }
  if (flags.count) springs.count = *flags.count;
  // These two mean something only with a geometry; beside a measured stiffness
  // alone they are passed over.
  if (springs.geometry) {
    rig::SpringGeometry& geometry = *springs.geometry;
    if (flags.total_coils) geometry.total_coils = *flags.total_coils;
    if (flags.density_kg_per_m3) {
      geometry.density_kg_per_m3 = *flags.density_kg_per_m3;
    }
  }
  if (flags.free_length_mm) {
    springs.free_length_m = *flags.free_length_mm * core::kMillimetre;
  }
  if (flags.allowable_shear_mpa) {
    springs.allowable_shear_pa = *flags.allowable_shear_mpa * kMega;
  }
  TakeEstimate(springs.mass_kg, "--spring-mass-g", flags.spring_mass_g, kGram);
  TakeEstimate(out.preload_m, "--preload-mm", flags.preload_mm,
               core::kMillimetre);
  TakeEstimate(out.mass_kg, "--mass-g", flags.mass_g, kGram);
  TakeEstimate(out.efficiency, "--efficiency", flags.efficiency, 1.0);
  TakeEstimate(out.barrel_friction, "--barrel-friction", flags.barrel_friction,
               1.0);
  TakeEstimate(out.loss_j, "--loss-j", flags.loss_j, 1.0);
  TakeEstimate(out.gravity_mps2, "--gravity-mps2", flags.gravity_mps2, 1.0);
  // Takes a u alone, of a setting whose value is not part of the description.
  // NaN and infinity are refused with the negative ones.
  const auto take_u = [](const char* flag, const std::optional<double>& given,
                         double unit, double& to) {
    if (!given) return;
    if (!(*given >= 0.0) || !std::isfinite(*given)) {
      throw std::invalid_argument(fmt::format(
          "{} is {:g}, must be at least 0 and finite", flag, *given));
    }
    to = *given * unit;
  };
  take_u("--u-compression-mm", flags.u_compression_mm, core::kMillimetre,
         out.u_compression_m);
  take_u("--u-elevation-deg", flags.u_elevation_deg, core::kDegree,
         out.u_elevation_rad);
  take_u("--u-height-mm", flags.u_height_mm, core::kMillimetre,
         out.u_muzzle_height_m);
  return out;
}

void RequireMass(const RigFlags& flags) {
  if (flags.rig.empty() && flags.mass_g.empty()) {
    throw std::invalid_argument(
        "--mass-g is missing: the mass of the body; give it, or --rig");
  }
}

}  // namespace touchdown::cli
