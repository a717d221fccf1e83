// Small clips with exact truth, rendered as they are read.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>

#include "tests/vision/synthetic_track.h"
#include "touchdown/core/body.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::pipeline::filmed {

struct Film {
  vision::synthetic::Throw thrown;
  vision::SceneCamera camera;
  vision::SceneLook look;
  vision::SceneTrouble trouble;
  double noise = 0.006;       // of full scale
  std::int64_t lead_in = 50;  // frames before the body is seen
  std::int64_t frames = 115;  // in all
  double contact_frame = 80.37;
};

// A sphere of 24 mm (or a block of 40 by 16 mm, nose up) at 1.3 m/s.
inline Film Default(core::BodyKind kind) {
  Film film;
  film.camera.width_px = 240;
  film.camera.height_px = 120;
  film.camera.px_per_m = 1000.0;
  film.camera.ground_point = {120.0, 96.3};
  film.camera.roll_rad = 0.4 * core::kDegree;
  film.camera.fps = 1000.0;
  film.look.gradient_x = 0.06;
  film.look.texture_amplitude = 0.03;
  vision::synthetic::Throw& t = film.thrown;
  t.kind = kind;
  t.before = {1.2, -0.55, 0.0};
  t.after = {1.0, 0.33, 0.0};
  t.half_long_m = t.half_short_m = 0.012;
  if (kind == core::BodyKind::kRectangle) {
    t.half_long_m = 0.02;
    t.half_short_m = 0.008;
    t.face_rad = 14.0 * core::kDegree;
    Rebound(t, 0.6);
    film.frames = 90;  // the leading corner is still in the air
  }
  return film;
}

inline vision::Scene BuildScene(Film film) {
  vision::Scene scene;
  film.thrown.contact_s = film.contact_frame / film.camera.fps;
  scene.camera = film.camera;
  scene.look = film.look;
  scene.trouble = film.trouble;
  const double full = (1 << film.camera.bit_depth) - 1;
  scene.noise.read_dn = film.noise * full;
  scene.frames = film.frames;
  const auto thrown = film.thrown;
  scene.body = thrown.kind == core::BodyKind::kSphere
                   ? core::Sphere({2.0 * thrown.half_long_m, 0.0})
                   : core::Rectangle({2.0 * thrown.half_long_m, 0.0},
                                     {2.0 * thrown.half_short_m, 0.0});
  const double seen_s =
      (static_cast<double>(film.lead_in) - 0.5) / film.camera.fps;
  scene.pose = [thrown, seen_s](double t) {
    return t < seen_s ? vision::ScenePose{{99.0, 99.0}, 0.0} : thrown.At(t);
  };
  return scene;
}

}  // namespace touchdown::pipeline::filmed
