// A shot as a file, schema touchdown.scene/1 (JSON). Degrees, millimetres and
// microseconds, with the unit in each name; `touchdown simulate --example`
// prints one. Required: schema, body, thrown, frames. Everything else has the
// defaults of vision/scene.h.
//
//   name        of the clip; default: the file's name
//   body        {"kind": "sphere", "diameter_mm"}
//               | {"kind": "rectangle", "long_mm", "short_mm"}
//   thrown      mu, restitution, gravity_mps2, gyration_radius_mm, and either
//     start     the state at frame lead_in_frames: x_mm, gap_mm (of the
//               lowest point), vx_mps, vy_mps, angle_deg, omega_rad_per_s
//     touchdown the state at first contact, free flight before it: frame,
//               speed_mps, approach_angle_deg, x_mm, angle_deg,
//               omega_rad_per_s
//   frames      in all; lead_in_frames of them before the body comes in sight
//   angle_kind, set_angle_deg, bounce_height_mm
//   camera      width_px, height_px, px_per_m, ground_x_px, ground_y_px,
//               roll_deg, travels ("right" | "left"), fps, exposure_us,
//               psf_sigma_px, bit_depth, lens ({"focal_px", "k1", "k2", "p1",
//               "p2", "k3", "cx_px", "cy_px"}), yaw_deg (needs a lens),
//               row_delay_us
//   look        body_level, background_level, ground_level, gradient_x,
//               gradient_y, texture_amplitude, texture_correlation_px,
//               texture_seed, hole, mark ({"level", "distance", "radius"}),
//               face ({"amplitude", "correlation_px", "seed"})
//   trouble     shading_x, shading_y, highlight_level, highlight_x,
//               highlight_y, highlight_sigma, shadow_depth, flicker_amplitude,
//               flicker_hz, wave_amplitude_px, wave_length_px, specks,
//               speck_diameter_px, speck_speed_px, speck_seed, obstacle
//               ({"x", "y", "width", "height"}), obstacle_level
//   noise       read_dn, shot_dn2_per_dn
#pragma once

#include <filesystem>
#include <string>

#include "app/simulate/simulate.h"

namespace touchdown::pipeline {

// Throws core::InputError naming the file and the JSON path of what is
// missing, unknown, of the wrong kind or out of range.
Shot ReadSceneFile(const std::filesystem::path& path);

// The same from text; `source` is what messages call it.
Shot ParseScene(const std::string& text, const std::string& source);

// As JSON, complete, with the state in `start`; ParseScene reads it back.
std::string SceneText(const Shot& shot);

// A shot worth trying: a sphere at 20 degrees.
Shot ExampleShot();

}  // namespace touchdown::pipeline
