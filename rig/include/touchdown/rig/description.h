// What the rig is: one commented TOML file, rig.toml (ExampleDescription()
// prints one). Everything measured on it bears its standard uncertainty.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "touchdown/core/body.h"
#include "touchdown/core/estimate.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/launch.h"
#include "touchdown/rig/spring.h"

namespace touchdown::rig {

// One spring, measured with caliper and scale: what Eq. (11) takes.
struct SpringGeometry {
  core::Estimate shear_modulus_pa;
  core::Estimate wire_diameter_m;
  core::Estimate coil_diameter_m;
  CoilDiameter coil_diameter = CoilDiameter::kMean;
  core::Estimate active_coils;
  double total_coils = 0.0;
  double density_kg_per_m3 = 7850.0;
};

struct Springs {
  int count = 2;  // side by side
  // At least one of the two. A measured stiffness (all springs together) is
  // used in the place of Eq. (11); the geometry then serves mass and stress.
  std::optional<SpringGeometry> geometry;
  std::optional<core::Estimate> stiffness_n_per_m;
  // Weighed, all springs together; else from the geometry, else 0.
  std::optional<core::Estimate> mass_kg;
  std::optional<double> free_length_m;
  std::optional<double> allowable_shear_pa;
};

struct Description {
  std::string name;

  Springs springs;

  // How the springs are used.
  core::Estimate preload_m;
  std::optional<double> compression_max_m;  // the travel of the trigger
  double u_compression_m = 0.0;             // with which it is set
  core::Estimate efficiency = {1.0, 0.0, std::nullopt};
  core::Estimate barrel_friction;
  core::Estimate loss_j;

  // Where the muzzle can stand. Height: of the body's centre above the ground
  // when it leaves the barrel.
  double elevation_min_rad = 0.0;
  double elevation_max_rad = 0.0;
  double u_elevation_rad = 0.0;
  double muzzle_height_min_m = 0.0;
  double muzzle_height_max_m = 0.0;
  double u_muzzle_height_m = 0.0;

  // What is thrown. No body: a point, whose centre falls to the ground.
  std::optional<core::Body> body;
  core::Estimate mass_kg;
  // Of the rectangle's long side to the barrel, leading end up, as it lies in
  // the barrel; and the spin that the release leaves (counter-clockwise with x
  // in the direction of travel: leading end rising).
  core::Estimate seat_angle_rad;
  core::Estimate spin_rad_per_s;

  // At sea level 9.780 (equator) to 9.832 (poles): standard value, and the
  // standard deviation of a uniform distribution over that range.
  core::Estimate gravity_mps2 = {core::kStandardGravity_mps2, 0.015,
                                 std::nullopt};
};

inline bool ThrowsRectangle(const Description& rig) {
  return rig.body && rig.body->kind == core::BodyKind::kRectangle;
}

// One of the springs, at the values of `springs`. Absent where the geometry is
// unknown.
core::Expected<Spring> MakeSpring(const Springs& springs);

// The barrel's energy balance at the values of the description. Throws
// std::invalid_argument where neither stiffness nor geometry is given.
Launch MakeLaunch(const Description& rig, double elevation_rad);

// Checks the springs at a travel of `compression_m` beyond the preload, and the
// travel against its limit. Without geometry only what can be is checked.
std::vector<Finding> CheckCompression(const Description& rig,
                                      double compression_m);

// Reads rig.toml. `name` is what errors call the text. A number may be given
// plain or as { value = 2.0, u = 0.01 }; a plain size of the body has u = 0.1
// %. Throws core::InputError "name:line:
// ..." where TOML does not parse, a key is unknown (listing the known ones),
// missing, of the wrong type or outside its range.
Description ParseDescription(std::string_view text, std::string_view name);
Description ReadDescription(const std::filesystem::path& path);

// A complete rig.toml with every key explained.
std::string_view ExampleDescription();

}  // namespace touchdown::rig
