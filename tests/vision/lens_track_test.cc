#include "touchdown/vision/contact/lens_track.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <vector>

#include "touchdown/calib/lens.h"

namespace touchdown::vision {
namespace {

// A strong lens: bodies near the border are bent by several hundredths.
calib::Lens StrongLens() {
  return {600.0, 600.0, 319.5, 239.5, -0.3, 0.09, 0.001, -0.0005, -0.01};
}

struct Circle {
  core::PixelPoint centre;
  double radius = 0.0;
};

// The circle that the distorted image of a disc fits best, by brute force.
Circle ImageOf(const calib::Lens& lens, core::PixelPoint centre,
               double radius) {
  Eigen::Vector3d c(0.0, 0.0, radius);
  const core::PixelPoint at = calib::Distort(lens, centre);
  c.head<2>() << at.x_px, at.y_px;
  for (int step = 0; step < 50; ++step) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    constexpr int kPoints = 720;
    for (int k = 0; k < kPoints; ++k) {
      const double a = 2.0 * std::numbers::pi * k / kPoints;
      const auto q = calib::Distort(lens, {centre.x_px + radius * std::cos(a),
                                           centre.y_px + radius * std::sin(a)});
      const Eigen::Vector2d d(q.x_px - c[0], q.y_px - c[1]);
      const Eigen::Vector3d row(d.x() / d.norm(), d.y() / d.norm(), 1.0);
      normal += row * row.transpose();
      right += row * (d.norm() - c[2]);
    }
    c += normal.inverse() * right;
  }
  return {{c[0], c[1]}, c[2]};
}

Track OneSphere(core::PixelPoint centre, double radius) {
  Track track;
  track.body.kind = core::BodyKind::kSphere;
  track.body.radius_px = {radius, 0.01, std::nullopt};
  Pose pose;
  pose.centre = centre;
  pose.u_x_px = 0.02;
  pose.u_y_px = 0.01;
  track.poses = {pose};
  return track;
}

TEST(Undistorted, FindsTheDiscBehindABentImage) {
  const calib::Lens lens = StrongLens();
  double most_bent = 0.0;
  for (const core::PixelPoint truth : {core::PixelPoint{80.0, 60.0},
                                       {320.0, 40.0},
                                       {560.0, 430.0},
                                       {600.0, 240.0},
                                       {319.5, 239.5}}) {
    constexpr double kRadius_px = 30.0;
    const Circle seen = ImageOf(lens, truth, kRadius_px);
    const Track ideal = Undistorted(OneSphere(seen.centre, seen.radius), lens);
    ASSERT_EQ(ideal.poses.size(), 1u);
    EXPECT_NEAR(ideal.poses[0].centre.x_px, truth.x_px, 1e-4);
    EXPECT_NEAR(ideal.poses[0].centre.y_px, truth.y_px, 1e-4);
    EXPECT_NEAR(ideal.body.radius_px.value, kRadius_px, 1e-4);
    const auto by_centre = calib::Undistort(lens, seen.centre);
    ASSERT_TRUE(by_centre);
    most_bent =
        std::max(most_bent, std::hypot(by_centre->point.x_px - truth.x_px,
                                       by_centre->point.y_px - truth.y_px));
  }
  // What undistorting the centre alone would have missed.
  EXPECT_GT(most_bent, 0.1);
}

TEST(Undistorted, CarriesTheCovarianceThroughTheJacobian) {
  const calib::Lens lens = StrongLens();
  Track track = OneSphere({90.0, 70.0}, 5.0);
  track.poses[0].correlation_xy = 0.3;
  const Track ideal = Undistorted(track, lens);
  ASSERT_EQ(ideal.poses.size(), 1u);
  const auto at = calib::Undistort(lens, {90.0, 70.0});
  ASSERT_TRUE(at);
  Eigen::Matrix2d c;
  c << 4e-4, 0.6e-4, 0.6e-4, 1e-4;
  const Eigen::Matrix2d expected = at->jacobian * c * at->jacobian.transpose();
  const Pose& p = ideal.poses[0];
  EXPECT_NEAR(p.u_x_px, std::sqrt(expected(0, 0)), 1e-9);
  EXPECT_NEAR(p.u_y_px, std::sqrt(expected(1, 1)), 1e-9);
  EXPECT_NEAR(p.correlation_xy * p.u_x_px * p.u_y_px, expected(0, 1), 1e-10);
}

// Corners of a small rectangle undistorted one by one tell its direction.
TEST(Undistorted, TurnsARectangleAsItsCornersTurn) {
  const calib::Lens lens = StrongLens();
  const core::PixelPoint centre{100.0, 80.0};
  constexpr double kAngle = 0.4;
  constexpr double kLong_px = 4.0;
  Track track;
  track.body.kind = core::BodyKind::kRectangle;
  track.body.half_long_px = {kLong_px, 0.01, std::nullopt};
  track.body.half_short_px = {1.0, 0.01, std::nullopt};
  Pose pose;
  pose.centre = centre;
  pose.angle_rad = kAngle;
  pose.u_x_px = pose.u_y_px = 0.01;
  pose.u_angle_rad = 0.002;
  track.poses = {pose};
  const Track ideal = Undistorted(track, lens);
  ASSERT_EQ(ideal.poses.size(), 1u);
  const auto end = [&](double sign) {
    return calib::Undistort(lens,
                            {centre.x_px + sign * kLong_px * std::cos(kAngle),
                             centre.y_px + sign * kLong_px * std::sin(kAngle)})
        ->point;
  };
  const core::PixelPoint a = end(-1.0);
  const core::PixelPoint b = end(1.0);
  // Sides shear, too; a rectangle that is fitted to a sheared one turns by
  // part of it: the weights are those of its sides (four to one here).
  const double by_long = std::atan2(b.y_px - a.y_px, b.x_px - a.x_px);
  EXPECT_NEAR(ideal.poses[0].angle_rad, by_long, 2e-3);
  EXPECT_GT(std::abs(by_long - kAngle), 8e-3);
  EXPECT_NEAR(2.0 * ideal.body.half_long_px.value,
              std::hypot(b.x_px - a.x_px, b.y_px - a.y_px), 0.02);
}

TEST(Undistorted, ASizeThatOnlyTheLensChangedIsSteady) {
  const calib::Lens lens = StrongLens();
  Track track = OneSphere({0.0, 0.0}, 20.0);
  track.poses.clear();
  for (int i = 0; i < 20; ++i) {
    const core::PixelPoint truth{100.0 + 20.0 * i, 100.0};
    const Circle seen = ImageOf(lens, truth, 20.0);
    Pose pose;
    pose.frame = i;
    pose.centre = seen.centre;
    pose.relative_size = seen.radius / 20.0;
    track.poses.push_back(pose);
  }
  track.warnings = {"the body's image changes size by 5 % over the clip"};
  const Track ideal = Undistorted(track, lens);
  EXPECT_TRUE(ideal.warnings.empty());
  for (const Pose& pose : ideal.poses) EXPECT_EQ(pose.relative_size, 1.0);
  EXPECT_NEAR(ideal.body.radius_px.value, 20.0, 0.02);
}

TEST(Undistorted, LeavesOutWhatTheModelDoesNotReach) {
  Track track = OneSphere({320.0, 240.0}, 10.0);
  track.poses.push_back(track.poses[0]);
  track.poses[1].frame = 1;
  track.poses[1].centre = {2500.0, 240.0};
  const Track ideal = Undistorted(track, StrongLens());
  EXPECT_EQ(ideal.poses.size(), 1u);
  EXPECT_THAT(ideal.warnings,
              ::testing::Contains(::testing::HasSubstr("in 1 frames")));
}

}  // namespace
}  // namespace touchdown::vision
