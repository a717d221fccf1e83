#include "touchdown/vision/contact/plane_track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/vision/synthetic_track.h"

namespace touchdown::vision {
namespace {

using namespace core::literals;  // NOLINT
using synthetic::Block;
using synthetic::FilmGround;
using synthetic::Filming;
using synthetic::FilmTrack;
using synthetic::Throw;
constexpr double kPi = std::numbers::pi;

Filming Exact() {
  Filming filming;
  filming.noise = false;
  return filming;
}

// Through the camera and back: plane coordinates are those of the motion, in
// px, whatever the camera's roll and the direction of travel.
TEST(PlaneTrack, InverseOfTheCamera) {
  for (const bool left : {false, true}) {
    for (const double roll : {-10.0_deg, 0.0, 0.4_deg, 15.0_deg}) {
      for (const bool rectangle : {false, true}) {
        Throw thrown = rectangle ? Block(0.4) : Throw{};
        thrown.before.omega = thrown.after.omega = rectangle ? 9.0 : 0.0;
        Filming filming = Exact();
        filming.camera.travels_left = left;
        filming.camera.roll_rad = roll;
        const PlaneTrack plane = synthetic::FilmPlane(thrown, filming);
        ASSERT_EQ(plane.samples.size(), 60u);
        EXPECT_EQ(plane.direction, left ? -1 : 1);
        const core::Body body = rectangle
                                    ? core::Rectangle({0.06, 0}, {0.02, 0})
                                    : core::Sphere({0.04, 0});
        for (const PlaneSample& s : plane.samples) {
          const ScenePose truth = thrown.At(s.time_s);
          EXPECT_NEAR(s.along_px, 1000.0 * truth.centre.x_m, 1e-8);
          EXPECT_NEAR(s.height_px, 1000.0 * truth.centre.y_m, 1e-8);
          EXPECT_NEAR(s.gap_px, 1000.0 * Gap(body, truth), 1e-8);
          if (rectangle) {
            EXPECT_NEAR(s.face_rad, truth.angle_rad, 1e-10);
          }
          const core::PixelPoint p = ToImage(plane, s.along_px, s.height_px);
          const core::PixelPoint q = ToImage(filming.camera, truth.centre);
          EXPECT_NEAR(p.x_px, q.x_px, 1e-8);
          EXPECT_NEAR(p.y_px, q.y_px, 1e-8);
        }
      }
    }
  }
}

TEST(PlaneTrack, ASideFacesTheGroundTwiceATurn) {
  // The first face angle lies in (-90, 90]; turning on, it is continuous.
  Throw thrown = Block(0.0);
  thrown.before.omega = 150.0;
  thrown.after.omega = 150.0;
  Filming filming = Exact();
  filming.frames = 120;
  Track track = FilmTrack(
      thrown,
      [&](double t) {
        return ScenePose{{t, 0.2}, 1.0 + 150.0 * t};
      },
      filming);
  for (const double turns : {-2.0, 0.0, 1.0, 5.0}) {
    Track turned = track;
    for (Pose& pose : turned.poses) pose.angle_rad += turns * kPi;
    const PlaneTrack plane = SeenFromGround(turned, FilmGround(filming));
    EXPECT_NEAR(plane.samples.front().face_rad, 1.0, 1e-9) << turns;
    EXPECT_NEAR(plane.samples.back().face_rad, 1.0 + 150.0 * 119.0 / 2000.0,
                1e-9);
  }
}

TEST(PlaneTrack, SupportOfARectangleByItsCorners) {
  PlaneTrack plane;
  plane.kind = core::BodyKind::kRectangle;
  plane.half_long_px = 30.0;
  plane.half_short_px = 10.0;
  for (double face = -7.0; face < 7.0; face += 0.0437) {
    double lowest = 1e9;
    double along = 0.0;
    for (const int i : {-1, 1}) {
      for (const int j : {-1, 1}) {
        const double x = i * 30.0 * std::cos(face) - j * 10.0 * std::sin(face);
        const double y = i * 30.0 * std::sin(face) + j * 10.0 * std::cos(face);
        if (y < lowest) {
          lowest = y;
          along = x;
        }
      }
    }
    EXPECT_NEAR(SupportHeight(plane, face), -lowest, 1e-9) << face;
    EXPECT_NEAR(LowestPointOffset(plane, face), along, 1e-9) << face;
  }
  // Flush: no corner is the lowest.
  EXPECT_EQ(LowestPointOffset(plane, 0.0), 0.0);
  plane.kind = core::BodyKind::kSphere;
  plane.half_long_px = 20.0;
  EXPECT_EQ(SupportHeight(plane, 1.234), 20.0);
  EXPECT_EQ(LowestPointOffset(plane, 1.234), 0.0);
}

// By differences of the corner's direction, atan2(short, long).
TEST(PlaneTrack, GammaTurnsACornerByTheDifferenceOfItsSides) {
  PlaneTrack plane;
  plane.half_long_px = 30.0;
  plane.half_short_px = 10.0;
  plane.gamma_long_px = 0.01;
  plane.gamma_short_px = 0.01;
  EXPECT_NEAR(CornerTurnByGamma(plane),
              std::atan2(10.01, 30.01) - std::atan2(10.0, 30.0), 1e-7);
  // Sides that move in their own ratio, and those of a square, leave it.
  plane.gamma_long_px = 0.03;
  EXPECT_NEAR(CornerTurnByGamma(plane), 0.0, 1e-12);
  plane.half_short_px = 30.0;
  plane.gamma_short_px = 0.03;
  EXPECT_NEAR(CornerTurnByGamma(plane), 0.0, 1e-12);
}

TEST(PlaneTrack, UncertaintyTurnsWithTheLine) {
  Filming filming = Exact();
  filming.camera.roll_rad = 0.0;
  Throw thrown;
  Track track = FilmTrack(
      thrown, [&](double t) { return thrown.At(t); }, filming);
  for (Pose& pose : track.poses) {
    pose.u_x_px = 0.3;
    pose.u_y_px = 0.1;
    pose.correlation_xy = 0.0;
  }
  const PlaneTrack level = SeenFromGround(track, FilmGround(filming));
  EXPECT_NEAR(level.samples[0].u_along_px, 0.3, 1e-12);
  EXPECT_NEAR(level.samples[0].u_height_px, 0.1, 1e-12);
  // At 45 degrees both are the root of the mean square, and with full
  // correlation one axis carries all of it: (u_x +- u_y)^2 / 2.
  const auto steep = calib::MakeGroundLine({0, 0}, {400, 400});
  PlaneTrack turned = SeenFromGround(track, steep);
  const double mean = std::sqrt((0.09 + 0.01) / 2.0);
  EXPECT_NEAR(turned.samples[0].u_along_px, mean, 1e-12);
  EXPECT_NEAR(turned.samples[0].u_height_px, mean, 1e-12);
  for (Pose& pose : track.poses) pose.correlation_xy = 1.0;
  turned = SeenFromGround(track, steep);
  EXPECT_NEAR(turned.samples[0].u_along_px, 0.4 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(turned.samples[0].u_height_px, 0.2 / std::sqrt(2.0), 1e-12);
}

TEST(PlaneTrack, GapOfATiltedBlockCarriesItsAngle) {
  Filming filming = Exact();
  filming.u_angle_rad = 1e-2;
  const PlaneTrack plane = synthetic::FilmPlane(Block(0.5), filming);
  const PlaneSample& s = plane.samples.front();
  const double arm = LowestPointOffset(plane, s.face_rad);
  EXPECT_NEAR(s.u_gap_px, std::hypot(0.02, arm * 1e-2), 1e-9);
}

TEST(PlaneTrack, BodyThatGrowsLowersItsGap) {
  Filming filming = Exact();
  Throw thrown;
  Track track = FilmTrack(
      thrown, [&](double t) { return thrown.At(t); }, filming);
  const double before =
      SeenFromGround(track, FilmGround(filming)).samples[3].gap_px;
  track.poses[3].relative_size = 1.1;
  EXPECT_NEAR(SeenFromGround(track, FilmGround(filming)).samples[3].gap_px,
              before - 2.0, 1e-9);
}

TEST(PlaneTrack, EmptyTrackIsEmpty) {
  EXPECT_TRUE(SeenFromGround(Track{}, calib::MakeGroundLine({0, 0}, {1, 0}))
                  .samples.empty());
}

TEST(PlaneTrack, OriginFarAwayChangesNothing) {
  Throw thrown = Block(0.3);
  const PlaneTrack near = synthetic::FilmPlane(thrown, Exact());
  Filming filming = Exact();
  filming.camera.ground_point = {1e6 + 320.0, -1e6 + 330.0};
  const PlaneTrack far = synthetic::FilmPlane(thrown, filming);
  for (std::size_t i = 0; i < near.samples.size(); ++i) {
    EXPECT_NEAR(near.samples[i].along_px, far.samples[i].along_px, 2e-5);
    EXPECT_NEAR(near.samples[i].gap_px, far.samples[i].gap_px, 2e-5);
  }
}

}  // namespace
}  // namespace touchdown::vision
