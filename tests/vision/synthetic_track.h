// Tracks with known truth, without a pixel: poses of a body that follows closed
// forms, seen by a camera, with normal noise of the stated size.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>

#include "touchdown/calib/plane.h"
#include "touchdown/core/units.h"
#include "touchdown/vision/contact/contact.h"
#include "touchdown/vision/contact/plane_track.h"
#include "touchdown/vision/synthetic/scene.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::vision::synthetic {

// One throw at the ground y = 0 in the plane frame (SI). Before `contact_s` the
// centre falls freely; at contact it has the velocity `before`; until contact_s
// + duration_s it is pressed down; then it leaves with `after`. With `stays` it
// never leaves and moves on with after.vx.
struct Velocity {
  double vx = 0.0;
  double vy = 0.0;
  double omega = 0.0;
};

struct Throw {
  core::BodyKind kind = core::BodyKind::kSphere;
  double half_long_m = 0.02;   // a sphere's radius
  double half_short_m = 0.02;  //
  double contact_s = 0.01512;
  double x_m = 0.0;       // of the centre at contact
  double face_rad = 0.0;  // at contact
  Velocity before{1.4, -0.6, 0.0};
  Velocity after{1.2, 0.3, 0.0};
  double duration_s = 0.0;
  bool stays = false;
  bool marked = false;  // a sphere whose marks show how it turns
  double gravity_mps2 = core::kStandardGravity_mps2;

  double Support(double face) const {
    if (kind == core::BodyKind::kSphere) return half_long_m;
    return half_long_m * std::abs(std::sin(face)) +
           half_short_m * std::abs(std::cos(face));
  }
  // The lowest point from the centre, along x.
  double Arm() const {
    if (kind == core::BodyKind::kSphere) return 0.0;
    const double s = std::sin(face_rad);
    const double c = std::cos(face_rad);
    return s > 0.0 ? -half_long_m * c + half_short_m * s
                   : half_long_m * c + half_short_m * s;
  }
  double ContactAngle() const { return std::atan2(-before.vy, before.vx); }

  ScenePose At(double time_s) const {
    ScenePose pose;
    const double t = time_s - contact_s;
    const double down = Support(face_rad);
    if (t <= 0.0) {
      pose.centre = {x_m + before.vx * t,
                     down + before.vy * t - 0.5 * gravity_mps2 * t * t};
      pose.angle_rad = face_rad + before.omega * t;
      return pose;
    }
    if (stays) {
      pose.centre = {x_m + after.vx * t, down};
      pose.angle_rad = face_rad;
      if (marked) pose.angle_rad += after.omega * t;
      return pose;
    }
    // Down for a while: from one velocity to the other without a jump (the
    // cubic with these slopes at its two zeros), x at constant acceleration.
    pose.centre = {x_m, down};
    pose.angle_rad = face_rad;
    if (duration_s > 0.0) {
      const double s = std::fmin(t / duration_s, 1.0);
      const double d = duration_s;
      pose.centre.x_m += d * s * (before.vx + 0.5 * s * (after.vx - before.vx));
      pose.centre.y_m +=
          d * s * (1.0 - s) * (before.vy * (1.0 - s) - after.vy * s);
      if (t <= duration_s) return pose;
    }
    const double s = t - duration_s;
    pose.centre.x_m += after.vx * s;
    pose.centre.y_m += after.vy * s - 0.5 * gravity_mps2 * s * s;
    pose.angle_rad += after.omega * s;
    return pose;
  }
};

// 60 x 20 mm.
inline Throw Block(double face_rad) {
  Throw thrown;
  thrown.kind = core::BodyKind::kRectangle;
  thrown.half_long_m = 0.03;
  thrown.half_short_m = 0.01;
  thrown.face_rad = face_rad;
  return thrown;
}

// Gives a rectangle the velocities after a frictionless impact at its lowest
// point with restitution `e` (impulse J along the normal; unit mass, k^2 =
// (a^2 + b^2)/3 for half sides a, b):
//   v' = v + J, w' = w + J x / k^2, v' + w' x = -e (v + w x).
inline void Rebound(Throw& thrown, double e) {
  const double x = thrown.Arm();
  const double k2 = (thrown.half_long_m * thrown.half_long_m +
                     thrown.half_short_m * thrown.half_short_m) /
                    3.0;
  const double p = thrown.before.vy + thrown.before.omega * x;
  const double j = -(1.0 + e) * p / (1.0 + x * x / k2);
  thrown.after = {thrown.before.vx, thrown.before.vy + j,
                  thrown.before.omega + j * x / k2};
}

struct Filming {
  int frames = 60;
  SceneCamera camera;  // px_per_m, ground, roll, direction, fps
  double u_px = 0.02;
  double u_angle_rad = 2e-4;
  double u_ground_px = 0.02;
  double u_ground_rad = 1e-4;
  double first_time_s = 0.0;
  std::uint64_t seed = 1;
  bool noise = true;
};

using Motion = std::function<ScenePose(double)>;

inline Track FilmTrack(const Throw& body, const Motion& motion,
                       const Filming& filming) {
  std::mt19937_64 engine(filming.seed);
  std::normal_distribution<double> normal(0.0, filming.noise ? 1.0 : 0.0);
  const SceneCamera& camera = filming.camera;
  Track track;
  track.body.kind = body.kind;
  track.body.radius_px = {body.half_long_m * camera.px_per_m, 0.003};
  track.body.half_long_px = {body.half_long_m * camera.px_per_m, 0.003};
  track.body.half_short_px = {body.half_short_m * camera.px_per_m, 0.003};
  track.body.blur_px = 0.8;
  track.body.contrast_dn = -100.0;
  track.last_frame = filming.frames;
  track.frame_interval_s = 1.0 / camera.fps;
  for (int i = 0; i < filming.frames; ++i) {
    Pose pose;
    pose.frame = i;
    pose.time_s = filming.first_time_s + i / camera.fps;
    const ScenePose truth = motion(pose.time_s);
    pose.centre = ToImage(camera, truth.centre);
    pose.centre.x_px += filming.u_px * normal(engine);
    pose.centre.y_px += filming.u_px * normal(engine);
    pose.u_x_px = pose.u_y_px = filming.u_px;
    pose.misfit = 1.0;
    if (body.kind == core::BodyKind::kRectangle || body.marked) {
      const double direction = camera.travels_left ? -1.0 : 1.0;
      pose.angle_rad = camera.roll_rad - direction * truth.angle_rad +
                       filming.u_angle_rad * normal(engine);
      pose.u_angle_rad = filming.u_angle_rad;
    }
    track.poses.push_back(pose);
  }
  return track;
}

// The ground line as measured: off the truth by its stated uncertainty.
inline calib::GroundLine FilmGround(const Filming& filming) {
  std::mt19937_64 engine(filming.seed + 1000003);
  std::normal_distribution<double> normal(0.0, filming.noise ? 1.0 : 0.0);
  const SceneCamera& camera = filming.camera;
  const double angle = camera.roll_rad + filming.u_ground_rad * normal(engine);
  const double off = filming.u_ground_px * normal(engine);
  const core::PixelPoint at{camera.ground_point.x_px + off * std::sin(angle),
                            camera.ground_point.y_px - off * std::cos(angle)};
  calib::GroundLine ground;
  ground.p1 = {at.x_px - 300.0 * std::cos(angle),
               at.y_px - 300.0 * std::sin(angle)};
  ground.p2 = {at.x_px + 300.0 * std::cos(angle),
               at.y_px + 300.0 * std::sin(angle)};
  ground.reference = at;
  ground.u_offset_px = filming.u_ground_px;
  ground.u_angle_rad = filming.u_ground_rad;
  return ground;
}

inline PlaneTrack FilmPlane(const Throw& thrown, const Filming& filming) {
  return SeenFromGround(
      FilmTrack(
          thrown, [&](double t) { return thrown.At(t); }, filming),
      FilmGround(filming));
}

inline ContactOptions WithScale(const Filming& filming) {
  ContactOptions options;
  options.scale = calib::Scale{
      {filming.camera.px_per_m, 1e-4 * filming.camera.px_per_m, std::nullopt},
      calib::ScaleSource::kUser};
  return options;
}

}  // namespace touchdown::vision::synthetic
