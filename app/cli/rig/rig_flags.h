// The rig on the command line: a rig.toml, single values, or the first
// corrected by the second.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "app/cli/command.h"
#include "app/cli/options.h"
#include "touchdown/core/estimate.h"
#include "touchdown/rig/description.h"

namespace touchdown::cli {

// Texts as typed; a measured number is VALUE or VALUE+-U, e.g. 2.0+-0.01.
struct RigFlags {
  std::string rig;
  std::optional<int> count;
  std::string shear_modulus_gpa, wire_mm, coil_mm, coil_diameter, active_coils;
  std::optional<double> total_coils, density_kg_per_m3;
  std::optional<double> free_length_mm, allowable_shear_mpa;
  std::string stiffness_n_per_m, spring_mass_g;
  std::string preload_mm, efficiency, barrel_friction, loss_j;
  std::optional<double> u_compression_mm, u_elevation_deg, u_height_mm;
  std::string mass_g, gravity_mps2;
};

// Adds --rig, which it returns, and a flag for each value of the springs.
Option AddSpringFlags(CLI::App& app, RigFlags& flags);

// Adds a flag for each value of ejector, muzzle and body's mass.
void AddLaunchFlags(CLI::App& app, RigFlags& flags);

// The description that the flags make. Throws std::invalid_argument naming the
// flag that is missing or impossible, core::InputError for the file.
rig::Description MakeDescription(const RigFlags& flags);

// Throws std::invalid_argument where neither rig.toml nor --mass-g was given:
// with the default mass of a description, speed and efficiency would be wrong.
void RequireMass(const RigFlags& flags);

}  // namespace touchdown::cli
