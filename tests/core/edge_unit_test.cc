#include "touchdown/core/edge_unit.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "touchdown/core/units.h"

namespace touchdown::core {
namespace {

struct Case {
  std::string inner;
  std::string edge;
  double factor;
};

TEST(AtTheEdge, ConvertsEveryUnitInUse) {
  for (const Case& c : std::vector<Case>{
           {"approach_angle_rad", "approach_angle_deg", core::kDegree},
           {"before_omega_rad_per_s", "before_omega_rad_per_s", 1.0},
           {"before_speed_mps", "before_speed_mps", 1.0},
           {"gravity_check_mps2", "gravity_check_mps2", 1.0},
           {"wire_diameter_m", "wire_diameter_mm", core::kMillimetre},
           {"stiffness_n_per_m", "stiffness_n_per_m", 1.0},
           {"shear_modulus_pa", "shear_modulus_gpa", 1e9},
           {"mass_kg", "mass_g", 1e-3},
           {"temperature_k", "temperature_c", 1.0},
           {"relative_humidity", "relative_humidity", 1.0},
           {"friction", "friction", 1.0},
       }) {
    const EdgeUnit unit = AtTheEdge(c.inner);
    EXPECT_EQ(unit.stem + unit.suffix, c.edge);
    EXPECT_EQ(unit.factor, c.factor) << c.inner;
    EXPECT_EQ(unit.offset, c.inner == "temperature_k" ? 273.15 : 0.0);
  }
}

}  // namespace
}  // namespace touchdown::core
