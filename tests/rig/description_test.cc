#include "touchdown/rig/description.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"
#include "touchdown/rig/setpoints.h"

namespace touchdown::rig {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

// The least that a rig.toml must say; each key on a line of its own.
constexpr const char* kLeast =
    "schema = \"touchdown.rig/1\"\n"    // 1
    "[springs]\n"                       // 2
    "shear_modulus_gpa = 79.3\n"        // 3
    "wire_diameter_mm = 2.0\n"          // 4
    "coil_diameter_mm = 18\n"           // 5
    "coil_diameter_kind = \"outer\"\n"  // 6
    "active_coils = 10\n"               // 7
    "[muzzle]\n"                        // 8
    "elevation_min_deg = -10\n"         // 9
    "elevation_max_deg = 60\n"          // 10
    "height_min_mm = 100\n"             // 11
    "height_max_mm = 500\n"             // 12
    "[body]\n"                          // 13
    "kind = \"sphere\"\n"               // 14
    "diameter_mm = 40\n"                // 15
    "mass_g = 100\n";                   // 16

// kLeast with `from` replaced by `to`.
std::string With(const std::string& from, const std::string& to) {
  std::string text = kLeast;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string ErrorOf(const std::string& text) {
  try {
    (void)ParseDescription(text, "rig.toml");
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "nothing thrown";
}

// What the program prints for people to start from is a rig that may be built:
// nothing to warn of at its full travel, and the plan of the README is
// possible.
TEST(Description, ExampleIsSafeAndFeasible) {
  const Description rig = ParseDescription(ExampleDescription(), "example");
  ASSERT_TRUE(rig.compression_max_m);
  for (const Finding& f : CheckCompression(rig, *rig.compression_max_m)) {
    ADD_FAILURE() << f.what;
  }
  for (const double deg : {20.0, 25.0, 30.0}) {
    ContactWish wish;
    wish.kind = core::AngleKind::kRadius;
    wish.angle_rad = deg * core::kDegree;
    wish.speed_mps = 4.0;
    EXPECT_TRUE(FindSetting(rig, wish)) << deg;
  }
}

TEST(Description, ExampleIsComplete) {
  const Description rig = ParseDescription(ExampleDescription(), "example");
  EXPECT_EQ(rig.name, "bench ejector");
  ASSERT_TRUE(rig.springs.geometry);
  EXPECT_NEAR(rig.springs.geometry->wire_diameter_m.value, 2e-3, 1e-18);
  EXPECT_NEAR(rig.springs.geometry->wire_diameter_m.u, 1e-5, 1e-20);
  EXPECT_EQ(rig.springs.geometry->coil_diameter, CoilDiameter::kOuter);
  EXPECT_NEAR(Stiffness(*MakeSpring(rig.springs)), 7744.140625, 1e-9);
  EXPECT_NEAR(rig.elevation_min_rad, -60.0 * core::kDegree, 1e-15);
  EXPECT_NEAR(rig.u_muzzle_height_m, 1e-3, 1e-18);
  ASSERT_TRUE(rig.body);
  EXPECT_EQ(rig.body->kind, core::BodyKind::kRectangle);
  EXPECT_NEAR(rig.spin_rad_per_s.u, 5.0 * core::kDegree, 1e-15);
  EXPECT_NEAR(rig.gravity_mps2.u, 0.005, 1e-18);
  // Each commented line is a key that works when it is uncommented.
  std::string text(ExampleDescription());
  for (const char* key : {"# stiffness_n_per_m =", "# mass_g ="}) {
    const std::size_t at = text.find(key);
    ASSERT_NE(at, std::string::npos);
    text.erase(at, 2);
  }
  const Description full = ParseDescription(text, "example");
  EXPECT_EQ(full.springs.stiffness_n_per_m->value, 7744.0);
  EXPECT_NEAR(full.springs.mass_kg->value, 0.0298, 1e-15);
}

TEST(Description, DefaultsAreStated) {
  const Description rig = ParseDescription(kLeast, "rig.toml");
  EXPECT_EQ(rig.springs.count, 2);
  EXPECT_EQ(rig.springs.geometry->total_coils, 12.0);
  EXPECT_EQ(rig.springs.geometry->density_kg_per_m3, 7850.0);
  EXPECT_EQ(rig.efficiency.value, 1.0);
  EXPECT_EQ(rig.springs.geometry->wire_diameter_m.u, 0.0);
  EXPECT_FALSE(rig.compression_max_m);
  EXPECT_EQ(rig.gravity_mps2.value, core::kStandardGravity_mps2);
}

TEST(Description, MeasuredStiffnessNeedsNoGeometry) {
  std::string text = kLeast;
  const std::size_t from = text.find("shear");
  text.replace(from, text.find("[muzzle]") - from,
               "stiffness_n_per_m = { value = 7000, u = 20 }\n");
  const Description rig = ParseDescription(text, "rig.toml");
  EXPECT_FALSE(rig.springs.geometry);
  EXPECT_FALSE(MakeSpring(rig.springs));
  EXPECT_EQ(MakeLaunch(rig, 0.0).stiffness_n_per_m, 7000.0);
  EXPECT_EQ(MakeLaunch(rig, 0.0).spring_mass_kg, 0.0);
}

TEST(Description, MeasuredStiffnessThatDisagreesWarns) {
  // As if the outer diameter had been taken for the mean: 42 % off.
  const Description rig =
      ParseDescription(With("active_coils = 10\n",
                            "active_coils = 10\nstiffness_n_per_m = 5439\n"),
                       "rig.toml");
  EXPECT_EQ(MakeLaunch(rig, 0.0).stiffness_n_per_m, 5439.0);
  bool said = false;
  for (const Finding& f : CheckCompression(rig, 0.01)) {
    said = said || f.what.find("check coil_diameter_kind") != std::string::npos;
  }
  EXPECT_TRUE(said);
}

TEST(Description, ErrorsNameFileAndLine) {
  EXPECT_THAT(
      ErrorOf(With("active_coils = 10", "active_coil = 10")),
      StartsWith("rig.toml:7: unknown key springs.active_coil, expected "
                 "one of: count, "));
  EXPECT_THAT(ErrorOf(With("[body]", "colour = 1\n[body]")),
              StartsWith("rig.toml:13: unknown key muzzle.colour"));
  EXPECT_THAT(ErrorOf(With("[muzzle]", "[nozzle]")),
              StartsWith("rig.toml:8: unknown key nozzle"));
  EXPECT_THAT(ErrorOf(With("= 79.3", "= 79,3")),
              StartsWith("rig.toml:3: not valid TOML"));
  EXPECT_THAT(ErrorOf(With("wire_diameter_mm = 2.0\n", "")),
              StartsWith("rig.toml:2: springs.wire_diameter_mm is missing"));
  EXPECT_THAT(ErrorOf(With("= 2.0", "= -2.0")),
              StartsWith("rig.toml:4: springs.wire_diameter_mm is -2, must be "
                         "positive"));
  EXPECT_THAT(ErrorOf(With("= 2.0", "= nan")),
              StartsWith("rig.toml:4: springs.wire_diameter_mm is nan"));
  EXPECT_THAT(ErrorOf(With("= 2.0", "= \"2.0\"")),
              StartsWith("rig.toml:4: springs.wire_diameter_mm must be a "
                         "number"));
  EXPECT_THAT(ErrorOf(With("= 2.0", "= { value = 2.0, sigma = 0.1 }")),
              StartsWith("rig.toml:4: unknown key "
                         "springs.wire_diameter_mm.sigma, expected one of: "
                         "value, u"));
  EXPECT_THAT(ErrorOf(With("= 2.0", "= { value = 2.0, u = -0.1 }")),
              StartsWith("rig.toml:4: springs.wire_diameter_mm.u is -0.1, must "
                         "be at least 0"));
  EXPECT_THAT(ErrorOf(With("= 2.0", "= { u = 0.1 }")),
              StartsWith("rig.toml:4: springs.wire_diameter_mm.value is "
                         "missing"));
  EXPECT_THAT(ErrorOf(With("\"outer\"", "\"D2\"")),
              StartsWith("rig.toml:6: springs.coil_diameter_kind is \"D2\", "
                         "must be mean, outer or inner"));
  EXPECT_THAT(ErrorOf(With("= 18", "= 4")),
              StartsWith("rig.toml:5: springs: mean coil diameter"));
  EXPECT_THAT(
      ErrorOf(With("active_coils = 10", "active_coils = 10\ntotal_coils = 9")),
      StartsWith("rig.toml:8: springs.total_coils is 9"));
  EXPECT_THAT(ErrorOf(With("[springs]", "[springs]\ncount = 1.5")),
              StartsWith("rig.toml:3: springs.count is 1.5"));
  EXPECT_THAT(ErrorOf(With("max_deg = 60", "max_deg = -60")),
              StartsWith("rig.toml:10: muzzle.elevation_max_deg is less"));
  EXPECT_THAT(ErrorOf(With("max_deg = 60", "max_deg = 100")),
              StartsWith("rig.toml:10: muzzle.elevation_max_deg is 100, must "
                         "be within -90 .. 90"));
  EXPECT_THAT(ErrorOf(With("= 500", "= 50")),
              StartsWith("rig.toml:12: muzzle.height_max_mm is less"));
  EXPECT_THAT(ErrorOf(With("\"sphere\"", "\"cube\"")),
              StartsWith("rig.toml:14: body.kind is \"cube\""));
  EXPECT_THAT(
      ErrorOf(With("diameter_mm = 40", "diameter_mm = 40\nseat_angle_deg = 1")),
      StartsWith("rig.toml:16: unknown key body.seat_angle_deg"));
  EXPECT_THAT(ErrorOf(With("rig/1", "rig/2")),
              StartsWith("rig.toml:1: schema is \"touchdown.rig/2\""));
  EXPECT_THAT(ErrorOf(With("\"sphere\"\ndiameter_mm = 40",
                           "\"rectangle\"\nlong_mm = 1\nshort_mm = 2")),
              StartsWith("rig.toml:15: body.long_mm is less than"));
  EXPECT_THAT(ErrorOf(""), StartsWith("rig.toml:"));
}

TEST(Description, MissingFileIsNamed) {
  try {
    (void)ReadDescription("/no/such/rig.toml");
    ADD_FAILURE();
  } catch (const core::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("/no/such/rig.toml: cannot be read"));
  }
}

TEST(Description, TravelIsChecked) {
  const Description rig =
      ParseDescription(ExampleDescription(), "example");  // up to 36 mm
  EXPECT_TRUE(Allowed(CheckCompression(rig, 0.035)));
  const auto findings = CheckCompression(rig, 0.041);
  ASSERT_FALSE(Allowed(findings));
  EXPECT_THAT(findings[0].what,
              HasSubstr("the trigger's travel ends at 36 mm"));
}

TEST(Description, WithoutAnySpringThereIsNoLaunch) {
  Description rig;
  rig.mass_kg = {0.1, 0.0, {}};
  EXPECT_THROW((void)MakeLaunch(rig, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::rig
