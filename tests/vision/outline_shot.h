// One picture of one body, with what an outline's fit needs beside it.
#pragma once

#include <cstdint>
#include <random>

#include "touchdown/vision/outline/outline.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::vision::testing {

// One picture of one body, at 1000 px a metre, so that millimetres are pixels.
struct Shot {
  Scene scene;
  Outline truth;
  SensorImage image;
  Background background;
};

struct ShotOptions {
  core::BodyKind kind = core::BodyKind::kSphere;
  double half_long_px = 20.0;
  double half_short_px = 10.0;
  double angle_rad = 0.0;
  int size_px = 80;
  double offset_px = 0.0;  // of the centre from the picture's, to the right
  double gap_px = 1e4;     // from a sphere to a level ground line below it
  double shadow_depth = 0.0;
  double body_level = 0.15;
  double background_level = 0.65;
  double gradient = 0.0;
  std::int32_t bit_depth = 8;
  double noise = 4.0 / 255.0;  // of full scale
  double psf_px = 0.7;
  std::uint64_t first_seed = 1;  // so that settings share no noise
};

inline Shot Take(std::uint64_t seed, const ShotOptions& options) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> within(-0.5, 0.5);
  Shot shot;
  Scene& scene = shot.scene;
  SceneCamera& camera = scene.camera;
  camera.width_px = camera.height_px = options.size_px;
  camera.bit_depth = options.bit_depth;
  camera.psf_sigma_px = options.psf_px;
  scene.look.body_level = options.body_level;
  scene.look.background_level = options.background_level;
  scene.look.gradient_x = options.gradient;
  scene.look.gradient_y = -0.7 * options.gradient;
  const double x = 0.5 * options.size_px + options.offset_px + within(engine);
  const double y = 0.5 * options.size_px + within(engine);
  const double turn = options.angle_rad + 0.02 * within(engine);
  const double ground_px = y + options.half_long_px + options.gap_px;
  camera.ground_point = {0.0, ground_px};
  scene.trouble.shadow_depth = options.shadow_depth;
  scene.pose = [=](double) {
    return ScenePose{{1e-3 * x, 1e-3 * (ground_px - y)}, -turn};
  };
  shot.truth.kind = options.kind;
  shot.truth.centre = {x, y};
  if (options.kind == core::BodyKind::kSphere) {
    scene.body = core::Sphere({2e-3 * options.half_long_px, 0.0});
    shot.truth.radius_px = options.half_long_px;
  } else {
    scene.body = core::Rectangle({2e-3 * options.half_long_px, 0.0},
                                 {2e-3 * options.half_short_px, 0.0});
    shot.truth.half_long_px = options.half_long_px;
    shot.truth.half_short_px = options.half_short_px;
    shot.truth.angle_rad = turn;
  }
  const double full = (1 << options.bit_depth) - 1;
  scene.noise.read_dn = options.noise * full;
  const SceneRenderer renderer(scene);
  shot.image = RenderFrame(renderer, 0, engine);
  shot.background.width_px = shot.background.height_px = options.size_px;
  shot.background.level = renderer.background().dn;
  shot.background.noise_floor_dn2 =
      scene.noise.read_dn * scene.noise.read_dn + 1.0 / 12.0;
  shot.background.full_scale_dn = full;
  return shot;
}

// Where a detector would start: off by a few pixels and some per cent.
inline Outline Near(const Outline& truth, std::mt19937_64& engine) {
  std::uniform_real_distribution<double> within(-1.0, 1.0);
  Outline start = truth;
  start.centre.x_px += 1.5 * within(engine);
  start.centre.y_px += 1.5 * within(engine);
  start.radius_px *= 1.0 + 0.06 * within(engine);
  start.half_long_px *= 1.0 + 0.06 * within(engine);
  start.half_short_px *= 1.0 + 0.06 * within(engine);
  start.angle_rad += 0.04 * within(engine);
  return start;
}

}  // namespace touchdown::vision::testing
