#include "touchdown/vision/contact/plane_track.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "numbers/robust.h"

namespace touchdown::vision {
namespace {

// A track as a camera would have seen it that looks straight at the plane of
// travel; the ground's reference point stays where it is.
struct Turned {
  Track track;
  calib::GroundLine ground;
  double size_stretch = 1.0;
};

Turned TurnedTrack(const Track& track, const calib::GroundLine& ground,
                   const YawedView& view) {
  Turned out{track, ground, 1.0};
  // Image directions of the plane's horizontal; y points down.
  const Eigen::Vector2d right = view.along;
  const Eigen::Vector2d down = -view.up;
  // Any two points give the line; 100 px apart no digit is lost.
  out.ground.p1 = {ground.reference.x_px - 100.0 * right.x(),
                   ground.reference.y_px - 100.0 * right.y()};
  out.ground.p2 = {ground.reference.x_px + 100.0 * right.x(),
                   ground.reference.y_px + 100.0 * right.y()};
  Eigen::Matrix2d to_image;
  to_image.col(0) = right;
  to_image.col(1) = -down;  // (right, height) to image coordinates
  std::vector<double> grown;
  std::vector<double> grown_long;
  std::vector<double> grown_short;
  for (Pose& pose : out.track.poses) {
    const InPlane at = ToPlane(view, pose.centre);
    const Eigen::Matrix2d j = to_image * at.jacobian;
    const Eigen::Vector2d centre =
        to_image * Eigen::Vector2d(at.right_px, at.height_px);
    pose.centre = {ground.reference.x_px + centre.x(),
                   ground.reference.y_px + centre.y()};
    Eigen::Matrix2d covariance;
    const double xy = pose.correlation_xy * pose.u_x_px * pose.u_y_px;
    // Place: C' = J C J^T, with the jacobian of the change of view.
    covariance << pose.u_x_px * pose.u_x_px, xy, xy, pose.u_y_px * pose.u_y_px;
    covariance = j * covariance * j.transpose();
    pose.u_x_px = std::sqrt(covariance(0, 0));
    pose.u_y_px = std::sqrt(covariance(1, 1));
    const double product = pose.u_x_px * pose.u_y_px;
    pose.correlation_xy =
        product > 0.0 ? std::clamp(covariance(0, 1) / product, -1.0, 1.0) : 0.0;
    grown.push_back(at.depth);
    if (track.body.kind != core::BodyKind::kRectangle) continue;
    const double c = std::cos(pose.angle_rad);
    const double s = std::sin(pose.angle_rad);
    const Eigen::Vector2d along = j * Eigen::Vector2d(c, s);
    grown_long.push_back(along.norm());
    // Sides stay parallel, but are no longer square to each other; the width
    // is across the long side.
    grown_short.push_back(j.determinant() / along.norm());
    const double turned = std::atan2(along.y(), along.x());
    pose.angle_rad +=
        std::remainder(turned - pose.angle_rad, 2.0 * std::numbers::pi);
    // A direction e turns by det(J) / |J e|^2 for each radian.
    pose.u_angle_rad *= j.determinant() / along.squaredNorm();
  }
  // The common size is a mean over the frames.
  const double common = Median(grown);
  for (std::size_t i = 0; i < grown.size(); ++i) {
    Pose& pose = out.track.poses[i];
    // 1: not followed, and the plane's own size is the same in all frames.
    if (pose.relative_size != 1.0) pose.relative_size *= grown[i] / common;
  }
  BodyImage& body = out.track.body;
  body.radius_px = core::Scaled(body.radius_px, common);
  body.whole_px *= common;
  out.size_stretch = common;
  if (!grown_long.empty()) {
    out.size_stretch = Median(grown_long);
    body.half_long_px = core::Scaled(body.half_long_px, out.size_stretch);
    body.half_short_px = core::Scaled(body.half_short_px, Median(grown_short));
  }
  return out;
}

// The track in the plane's coordinates for a camera that looks straight at it:
// a rotation by the line's angle, with y turned upward, and x' in the direction
// of travel.
PlaneTrack SeenStraight(const Track& track, const calib::GroundLine& ground) {
  PlaneTrack plane;
  plane.kind = track.body.kind;
  const bool sphere = plane.kind == core::BodyKind::kSphere;
  plane.half_long_px =
      sphere ? track.body.radius_px.value : track.body.half_long_px.value;
  plane.half_short_px =
      sphere ? track.body.radius_px.value : track.body.half_short_px.value;
  plane.u_half_px =
      sphere ? track.body.radius_px.u
             : std::fmax(track.body.half_long_px.u, track.body.half_short_px.u);
  plane.gamma_long_px = track.body.gamma_long_px;
  plane.gamma_short_px = track.body.gamma_short_px;
  plane.u_common_px = track.body.u_common_px;
  plane.u_common_face_rad = track.body.u_common_angle_rad;
  plane.u_texture_px = track.body.u_texture_px;
  plane.blur_px = track.body.blur_px;
  if (track.body.shutter_fraction > 0.0) {
    plane.exposure = std::min(1.0, track.body.shutter_fraction);
  }
  plane.is_predicted = track.is_predicted;
  // Of a body that was followed in part, the whole size is known from
  // elsewhere.
  plane.size_px = std::fmax(2.0 * plane.half_long_px, track.body.whole_px);
  plane.frame_interval_s = track.frame_interval_s;
  plane.last_frame = track.last_frame;
  plane.ground = ground;
  if (track.poses.empty()) return plane;

  const double ground_angle = calib::ImageAngle(ground);
  const bool ball_turns =
      sphere && std::all_of(track.poses.begin(), track.poses.end(),
                            [](const Pose& p) { return p.u_angle_rad > 0.0; });
  // x' points in the direction of travel, from the first pose to the last.
  const double displacement =
      calib::PositionOnLine(ground, track.poses.back().centre) -
      calib::PositionOnLine(ground, track.poses.front().centre);
  plane.direction = displacement < 0.0 ? -1 : 1;
  const double cosine = std::cos(ground_angle);
  const double sine = std::sin(ground_angle);
  // The first face angle lies in (-90, 90] degrees; later ones follow on.
  double turn = 0.0;
  for (const Pose& pose : track.poses) {
    PlaneSample s;
    s.frame = pose.frame;
    s.time_s = pose.time_s;
    s.along_px = plane.direction * calib::PositionOnLine(ground, pose.centre);
    s.height_px = calib::HeightAboveLine(ground, pose.centre);
    const double xx = pose.u_x_px * pose.u_x_px;
    const double yy = pose.u_y_px * pose.u_y_px;
    const double xy = pose.correlation_xy * pose.u_x_px * pose.u_y_px;
    // Variances along and across the line, with the correlation of x and y.
    // Rounding may make a tiny variance negative.
    s.u_along_px = std::sqrt(std::fmax(
        0.0,
        cosine * cosine * xx + 2.0 * cosine * sine * xy + sine * sine * yy));
    s.u_height_px =
        std::sqrt(std::fmax(0.0, sine * sine * xx - 2.0 * sine * cosine * xy +
                                     cosine * cosine * yy));
    double support = plane.half_long_px;
    double u_support = 0.0;
    if (ball_turns) {
      s.face_rad = -plane.direction * pose.angle_rad;
      s.u_face_rad = pose.u_angle_rad;
    } else if (!sphere) {
      // The image's y points down, the plane's up.
      s.face_rad = -plane.direction * (pose.angle_rad - ground_angle);
      if (plane.samples.empty()) {
        turn = std::remainder(s.face_rad, std::numbers::pi) - s.face_rad;
        if (s.face_rad + turn <= -0.5 * std::numbers::pi) {
          turn += std::numbers::pi;
        }
      }
      s.face_rad += turn;
      // Where the angle was held, its u is what an error of the centre moves an
      // end of the long side by.
      s.u_face_rad = pose.u_angle_rad > 0.0
                         ? pose.u_angle_rad
                         : std::hypot(pose.u_x_px, pose.u_y_px) /
                               std::fmax(plane.half_long_px, 1.0);
      support = SupportHeight(plane, s.face_rad);
      // d(support)/d(face) is where the lowest point is along x'.
      u_support = std::abs(LowestPointOffset(plane, s.face_rad)) * s.u_face_rad;
    }
    s.gap_px = s.height_px - support * pose.relative_size;
    s.u_gap_px = std::hypot(s.u_height_px, u_support);
    plane.samples.push_back(s);
  }
  return plane;
}

}  // namespace

PlaneTrack SeenFromGround(const Track& track, const calib::GroundLine& ground,
                          const std::optional<PlaneYaw>& yaw) {
  if (!yaw || track.poses.empty()) return SeenStraight(track, ground);
  // The turned plane is first seen as if from straight ahead; the ground line
  // of the picture stays with the result, since ToImage goes back through the
  // yaw.
  const YawedView view = MakeYawedView(ground, *yaw);
  const Turned turned = TurnedTrack(track, ground, view);
  PlaneTrack plane = SeenStraight(turned.track, turned.ground);
  plane.ground = ground;
  plane.yaw = yaw;
  plane.along_stretch =
      ToPlane(view, ground.reference).jacobian.row(0).dot(view.along);
  plane.size_stretch = turned.size_stretch;
  return plane;
}

core::PixelPoint ToImage(const PlaneTrack& track, double along_px,
                         double height_px) {
  if (track.yaw) {
    return FromPlane(MakeYawedView(track.ground, *track.yaw),
                     track.direction * along_px, height_px);
  }
  const double angle = calib::ImageAngle(track.ground);
  const double along = track.direction * along_px;
  return {track.ground.reference.x_px + along * std::cos(angle) +
              height_px * std::sin(angle),
          track.ground.reference.y_px + along * std::sin(angle) -
              height_px * std::cos(angle)};
}

double SupportHeight(const PlaneTrack& track, double face_rad) {
  if (track.kind == core::BodyKind::kSphere) return track.half_long_px;
  // S = a |sin face| + b |cos face|.
  return track.half_long_px * std::abs(std::sin(face_rad)) +
         track.half_short_px * std::abs(std::cos(face_rad));
}

double LowestPointOffset(const PlaneTrack& track, double face_rad) {
  if (track.kind == core::BodyKind::kSphere) return 0.0;
  const double s = std::sin(face_rad);
  const double c = std::cos(face_rad);
  if (s == 0.0 || c == 0.0) return 0.0;
  // The lowest corner is -sgn(s) a e1 - sgn(c) b e2 with e1 = (c, s), e2 = (-s,
  // c); this is its x'. On a face no corner is the lowest, and the offset is 0.
  return -std::copysign(track.half_long_px, s) * c +
         std::copysign(track.half_short_px, c) * s;
}

double CornerTurnByGamma(const PlaneTrack& track) {
  const double a = track.half_long_px;
  const double b = track.half_short_px;
  return std::abs(a * track.gamma_short_px - b * track.gamma_long_px) /
         (a * a + b * b);
}

}  // namespace touchdown::vision
