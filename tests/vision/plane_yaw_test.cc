// Oracle: a pinhole camera written out here, in the camera's own coordinates.
#include "touchdown/vision/contact/plane_yaw.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "touchdown/core/units.h"
#include "touchdown/vision/contact/plane_track.h"

namespace touchdown::vision {
namespace {

// A level camera, rolled by `roll`, and a plane through the point (x, y, z) of
// its coordinates (right, down, ahead; m), turned by `yaw` about the vertical.
struct Pinhole {
  double focal_px = 1000.0;
  core::PixelPoint axis{320.0, 200.0};
  double roll_rad = 0.0;
  double yaw_rad = 5.0 * core::kDegree;
  double x_m = 0.05, y_m = 0.1, z_m = 1.0;

  double DepthAt(double along_m) const {
    return z_m + along_m * std::sin(yaw_rad);
  }
  core::PixelPoint See(double along_m, double up_m) const {
    const double x = (x_m + along_m * std::cos(yaw_rad)) / DepthAt(along_m);
    const double y = (y_m - up_m) / DepthAt(along_m);
    const double c = std::cos(roll_rad);
    const double s = std::sin(roll_rad);
    return {axis.x_px + focal_px * (c * x - s * y),
            axis.y_px + focal_px * (s * x + c * y)};
  }
  calib::GroundLine Ground() const {
    calib::GroundLine line =
        calib::MakeGroundLine(See(-0.2, 0.0), See(0.2, 0.0), 0.1);
    line.reference = See(0.0, 0.0);
    return line;
  }
  PlaneYaw Yaw() const { return {yaw_rad, focal_px, axis}; }
};

// The direction of a picture's curve at its middle, by differences.
double SeenAngle(const Pinhole& camera, double angle_rad) {
  constexpr double kStep_m = 1e-6;
  const double dx = kStep_m * std::cos(angle_rad);
  const double dy = kStep_m * std::sin(angle_rad);
  const auto a = camera.See(-dx, dy);
  const auto b = camera.See(dx, -dy);
  return std::atan2(b.y_px - a.y_px, b.x_px - a.x_px);
}

TEST(PlaneYaw, IsTheTextbooksChangeOfAngle) {
  for (const double yaw_deg : {-8.0, -1.0, 3.0, 5.0}) {
    for (const double angle_deg : {2.0, 10.0, 35.0, 70.0}) {
      Pinhole camera;
      camera.yaw_rad = yaw_deg * core::kDegree;
      const double a = angle_deg * core::kDegree;
      // reference/statistics.md 4.3, with Y downwards and a descending path.
      const double seen = std::atan2(
          std::tan(a) - camera.y_m / camera.z_m * std::sin(camera.yaw_rad),
          std::cos(camera.yaw_rad) -
              camera.x_m / camera.z_m * std::sin(camera.yaw_rad));
      EXPECT_NEAR(SeenAngle(camera, a), seen, 1e-8);
      const YawedView view = MakeYawedView(camera.Ground(), camera.Yaw());
      const InPlane at = ToPlane(view, camera.See(0.0, 0.0));
      const Eigen::Vector2d v =
          at.jacobian * Eigen::Vector2d(std::cos(seen), std::sin(seen));
      EXPECT_NEAR(std::atan2(-v.y(), v.x()), a, 1e-7) << yaw_deg;
    }
  }
}

// The numbers of reference/statistics.md 4.3: a = 10 deg, yaw = 5 deg.
TEST(PlaneYaw, MattersToFirstOrderOffTheAxisAndToSecondOnIt) {
  Pinhole camera;
  camera.x_m = camera.y_m = 0.0;
  const double a = 10.0 * core::kDegree;
  EXPECT_NEAR((SeenAngle(camera, a) - a) / core::kDegree, 0.037, 0.0005);
  camera.y_m = -0.1;
  EXPECT_NEAR((SeenAngle(camera, a) - a) / core::kDegree, 0.52, 0.005);
}

TEST(PlaneYaw, UndoesThePinholeForRolledCameras) {
  for (const double roll_deg : {0.0, 0.4, -12.0, 45.0}) {
    for (const double yaw_deg : {-20.0, 0.3, 6.0}) {
      Pinhole camera;
      camera.roll_rad = roll_deg * core::kDegree;
      camera.yaw_rad = yaw_deg * core::kDegree;
      const YawedView view = MakeYawedView(camera.Ground(), camera.Yaw());
      const double px_per_m = camera.focal_px / camera.z_m;
      for (const double along : {-0.15, 0.0, 0.2}) {
        for (const double up : {0.0, 0.08}) {
          const InPlane p = ToPlane(view, camera.See(along, up));
          EXPECT_NEAR(p.right_px, along * px_per_m, 1e-7);
          EXPECT_NEAR(p.height_px, up * px_per_m, 1e-7);
          EXPECT_NEAR(p.depth, camera.DepthAt(along) / camera.z_m, 1e-10);
          const auto back = FromPlane(view, p.right_px, p.height_px);
          EXPECT_NEAR(back.x_px, camera.See(along, up).x_px, 1e-9);
          EXPECT_NEAR(back.y_px, camera.See(along, up).y_px, 1e-9);
        }
      }
      const core::PixelPoint at = camera.See(0.1, 0.05);
      const InPlane p = ToPlane(view, at);
      constexpr double kStep = 1e-4;
      const InPlane x = ToPlane(view, {at.x_px + kStep, at.y_px});
      const InPlane y = ToPlane(view, {at.x_px, at.y_px + kStep});
      EXPECT_NEAR((x.right_px - p.right_px) / kStep, p.jacobian(0, 0), 1e-5);
      EXPECT_NEAR((x.height_px - p.height_px) / kStep, p.jacobian(1, 0), 1e-5);
      EXPECT_NEAR((y.right_px - p.right_px) / kStep, p.jacobian(0, 1), 1e-5);
      EXPECT_NEAR((y.height_px - p.height_px) / kStep, p.jacobian(1, 1), 1e-5);
    }
  }
}

Track Falling(const Pinhole& camera, core::BodyKind kind) {
  Track track;
  track.body.kind = kind;
  const double px_per_m = camera.focal_px / camera.z_m;
  track.body.radius_px = {0.02 * px_per_m, 0.01, std::nullopt};
  track.body.half_long_px = {0.03 * px_per_m, 0.01, std::nullopt};
  track.body.half_short_px = {0.01 * px_per_m, 0.01, std::nullopt};
  track.frame_interval_s = 1e-3;
  for (int i = -10; i <= 10; ++i) {
    Pose pose;
    pose.frame = i + 10;
    pose.time_s = 1e-3 * i;
    pose.centre = camera.See(0.01 * i, 0.05);
    pose.u_x_px = 0.02;
    pose.u_y_px = 0.01;
    const auto tip = camera.See(0.01 * i + 1e-6, 0.05 + 0.3e-6);
    pose.angle_rad =
        std::atan2(tip.y_px - pose.centre.y_px, tip.x_px - pose.centre.x_px);
    pose.u_angle_rad = 1e-3;
    track.poses.push_back(pose);
  }
  return track;
}

TEST(SeenFromGround, IsThePlanesOwnWithAKnownYaw) {
  Pinhole camera;
  camera.roll_rad = 2.0 * core::kDegree;
  const Track track = Falling(camera, core::BodyKind::kRectangle);
  const double px_per_m = camera.focal_px / camera.z_m;
  const PlaneTrack plane = SeenFromGround(track, camera.Ground(), camera.Yaw());
  const PlaneTrack without = SeenFromGround(track, camera.Ground());
  double worst = 0.0;
  for (std::size_t i = 0; i < plane.samples.size(); ++i) {
    const PlaneSample& s = plane.samples[i];
    const double along = 0.01 * (static_cast<double>(i) - 10.0);
    EXPECT_NEAR(s.along_px, along * px_per_m, 1e-6);
    EXPECT_NEAR(s.height_px, 0.05 * px_per_m, 1e-6);
    EXPECT_NEAR(s.face_rad, std::atan(0.3), 1e-4);
    const auto back = ToImage(plane, s.along_px, s.height_px);
    EXPECT_NEAR(back.x_px, track.poses[i].centre.x_px, 1e-8);
    EXPECT_NEAR(back.y_px, track.poses[i].centre.y_px, 1e-8);
    worst = std::max(worst, std::abs(without.samples[i].height_px - 50.0));
  }
  EXPECT_GT(worst, 0.3) << "the yaw does not matter here";
  // At the reference point a px of the image along the ground is
  // 1 / (cos - X sin) px of the plane.
  EXPECT_NEAR(
      plane.along_stretch,
      1.0 / (std::cos(camera.yaw_rad) - 0.05 * std::sin(camera.yaw_rad)),
      0.002);
}

TEST(SeenFromGround, WithoutALensUndoesTheCosineOnly) {
  Pinhole camera;
  PlaneYaw yaw = camera.Yaw();
  yaw.focal_px = std::numeric_limits<double>::infinity();
  const Track track = Falling(camera, core::BodyKind::kSphere);
  const PlaneTrack plain = SeenFromGround(track, camera.Ground());
  const PlaneTrack plane = SeenFromGround(track, camera.Ground(), yaw);
  for (std::size_t i = 0; i < plane.samples.size(); ++i) {
    EXPECT_NEAR(plane.samples[i].along_px,
                plain.samples[i].along_px / std::cos(camera.yaw_rad), 1e-9);
    EXPECT_NEAR(plane.samples[i].height_px, plain.samples[i].height_px, 1e-9);
    EXPECT_DOUBLE_EQ(plane.samples[i].gap_px - plane.samples[i].height_px,
                     plain.samples[i].gap_px - plain.samples[i].height_px);
  }
  yaw.yaw_rad = 0.0;
  const PlaneTrack same = SeenFromGround(track, camera.Ground(), yaw);
  EXPECT_NEAR(same.samples[3].along_px, plain.samples[3].along_px, 1e-9);
  EXPECT_NEAR(same.samples[3].u_along_px, plain.samples[3].u_along_px, 1e-12);
}

TEST(PlaneYaw, RefusesTheImpossible) {
  const Pinhole camera;
  PlaneYaw yaw = camera.Yaw();
  yaw.yaw_rad = 1.2;
  EXPECT_THAT([&] { MakeYawedView(camera.Ground(), yaw); },
              ::testing::ThrowsMessage<std::invalid_argument>(
                  ::testing::HasSubstr("yaw is")));
  yaw = camera.Yaw();
  yaw.focal_px = 0.0;
  EXPECT_THROW(MakeYawedView(camera.Ground(), yaw), std::invalid_argument);
  yaw.focal_px = 0.5;  // the plane vanishes 5.7 px to the right of the axis
  EXPECT_THROW(MakeYawedView(camera.Ground(), yaw), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::vision
