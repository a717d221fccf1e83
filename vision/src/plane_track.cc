#include "touchdown/vision/plane_track.h"

#include <cmath>
#include <numbers>

namespace touchdown::vision {

PlaneTrack SeenFromGround(const Track& track, const calib::GroundLine& ground) {
  PlaneTrack plane;
  plane.kind = track.body.kind;
  const bool sphere = plane.kind == core::BodyKind::kSphere;
  plane.half_long_px =
      sphere ? track.body.radius_px.value : track.body.half_long_px.value;
  plane.half_short_px =
      sphere ? track.body.radius_px.value : track.body.half_short_px.value;
  plane.u_half_px =
      sphere ? track.body.radius_px.u : track.body.half_short_px.u;
  plane.frame_interval_s = track.frame_interval_s;
  plane.last_frame = track.last_frame;
  plane.ground = ground;
  if (track.poses.empty()) return plane;

  const double ground_angle = calib::ImageAngle(ground);
  const double displacement =
      calib::PositionAlong(ground, track.poses.back().centre) -
      calib::PositionAlong(ground, track.poses.front().centre);
  plane.direction = displacement < 0.0 ? -1 : 1;
  const double cosine = std::cos(ground_angle);
  const double sine = std::sin(ground_angle);
  // The first face angle lies in (-90, 90] degrees; later ones follow on.
  double turn = 0.0;
  for (const Pose& pose : track.poses) {
    PlaneSample s;
    s.frame = pose.frame;
    s.time_s = pose.time_s;
    s.along_px = plane.direction * calib::PositionAlong(ground, pose.centre);
    s.height_px = calib::HeightAbove(ground, pose.centre);
    const double xx = pose.u_x_px * pose.u_x_px;
    const double yy = pose.u_y_px * pose.u_y_px;
    const double xy = pose.correlation_xy * pose.u_x_px * pose.u_y_px;
    s.u_along_px = std::sqrt(std::fmax(
        0.0,
        cosine * cosine * xx + 2.0 * cosine * sine * xy + sine * sine * yy));
    s.u_height_px =
        std::sqrt(std::fmax(0.0, sine * sine * xx - 2.0 * sine * cosine * xy +
                                     cosine * cosine * yy));
    double support = plane.half_long_px;
    double u_support = 0.0;
    if (!sphere) {
      // The image's y points down, the plane's up.
      s.face_rad = -plane.direction * (pose.angle_rad - ground_angle);
      if (plane.samples.empty()) {
        turn = std::remainder(s.face_rad, std::numbers::pi) - s.face_rad;
        if (s.face_rad + turn <= -0.5 * std::numbers::pi) {
          turn += std::numbers::pi;
        }
      }
      s.face_rad += turn;
      s.u_face_rad = pose.u_angle_rad;
      support = SupportHeight(plane, s.face_rad);
      // d(support)/d(face) is where the lowest point is along x'.
      u_support = std::abs(LowestPointAlong(plane, s.face_rad)) * s.u_face_rad;
    }
    s.gap_px = s.height_px - support * pose.relative_size;
    s.u_gap_px = std::hypot(s.u_height_px, u_support);
    plane.samples.push_back(s);
  }
  return plane;
}

core::PixelPoint ToImage(const PlaneTrack& track, double along_px,
                         double height_px) {
  const double angle = calib::ImageAngle(track.ground);
  const double along = track.direction * along_px;
  return {track.ground.reference.x_px + along * std::cos(angle) +
              height_px * std::sin(angle),
          track.ground.reference.y_px + along * std::sin(angle) -
              height_px * std::cos(angle)};
}

double SupportHeight(const PlaneTrack& track, double face_rad) {
  if (track.kind == core::BodyKind::kSphere) return track.half_long_px;
  return track.half_long_px * std::abs(std::sin(face_rad)) +
         track.half_short_px * std::abs(std::cos(face_rad));
}

double LowestPointAlong(const PlaneTrack& track, double face_rad) {
  if (track.kind == core::BodyKind::kSphere) return 0.0;
  const double s = std::sin(face_rad);
  const double c = std::cos(face_rad);
  if (s == 0.0 || c == 0.0) return 0.0;
  // The corner -sgn(s) a e1 - sgn(c) b e2 with e1 = (c, s), e2 = (-s, c).
  return -std::copysign(track.half_long_px, s) * c +
         std::copysign(track.half_short_px, c) * s;
}

}  // namespace touchdown::vision
