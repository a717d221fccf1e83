#include "touchdown/rig/description.h"

namespace touchdown::rig {

std::string_view ExampleDescription() {
  return R"toml(# rig.toml: the ejector, as measured. Every key bears its unit.
# A measured number is plain, or has its standard uncertainty beside it:
#   wire_diameter_mm = 2.0
#   wire_diameter_mm = { value = 2.0, u = 0.01 }
# A plain number is taken as exact, a plain size of the body as good to 0.1 %.
# Unknown keys are refused.
schema = "touchdown.rig/1"
name = "bench ejector"

[springs]
count = 2                        # equal springs side by side
# Geometry of one spring, for Eq. (11). Leave the five out only where
# stiffness_n_per_m is given.
shear_modulus_gpa = { value = 79.3, u = 0.8 }   # G of the wire
wire_diameter_mm = { value = 2.0, u = 0.01 }    # d
coil_diameter_mm = { value = 18.0, u = 0.09 }   # of the kind named next
coil_diameter_kind = "outer"     # mean, outer or inner: no default
active_coils = { value = 10.0, u = 0.1 }        # n
total_coils = 12.0               # with the closed ends; default active + 2
density_kg_per_m3 = 7850.0       # of the wire; default: spring steel
free_length_mm = 84.0            # L0; without it no coil clearance is checked
allowable_shear_mpa = 900.0      # about 0.45 of the wire's tensile strength
# Measured with `touchdown rig calibrate --force`: all springs together, used in
# the place of Eq. (11).
# stiffness_n_per_m = { value = 7744.0, u = 40.0 }
# Weighed, all springs together; without it from the geometry.
# mass_g = { value = 29.8, u = 0.1 }

[ejector]
preload_mm = 0.0                 # compression that stays when the body leaves
compression_max_mm = 36.0        # travel of the trigger; optional
u_compression_mm = 0.3           # how well a compression is set
# The next two come from `touchdown rig calibrate --speeds`.
efficiency = { value = 0.95, u = 0.02 }   # share of the springs' energy, (0, 2]
loss_j = 0.0                     # lost in each shot whatever the compression
barrel_friction = 0.0            # coefficient, of the body's weight

[muzzle]
elevation_min_deg = -60.0        # barrel above horizontal
elevation_max_deg = 60.0
u_elevation_deg = 0.2
height_min_mm = 150.0            # of the body's centre as it leaves the barrel
height_max_mm = 800.0
u_height_mm = 1.0

[body]
kind = "rectangle"               # sphere (diameter_mm) or rectangle
long_mm = { value = 60.0, u = 0.02 }
short_mm = { value = 20.0, u = 0.02 }
mass_g = { value = 100.0, u = 0.2 }
# Rectangles only: long side to barrel (leading end up), and spin at release.
seat_angle_deg = { value = 0.0, u = 0.3 }
spin_deg_per_s = { value = 0.0, u = 5.0 }

[site]
gravity_mps2 = { value = 9.81, u = 0.005 }  # default 9.80665, u = 0.015
)toml";
}

}  // namespace touchdown::rig
