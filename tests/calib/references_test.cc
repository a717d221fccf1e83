#include "touchdown/calib/references.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/calib/board_picture.h"
#include "tests/support/statistics.h"
#include "touchdown/core/units.h"

namespace touchdown::calib {
namespace {

using namespace core::literals;  // NOLINT

TEST(MeasureScale, IsLengthInPixelsOverLength) {
  const ScaleRecord scale =
      MeasureScale({{100.0, 50.0}, {400.0, 450.0}, 0.5}, {0.25, 1e-4});
  EXPECT_DOUBLE_EQ(scale.px_per_m.value, 2000.0);
  EXPECT_NEAR(scale.px_per_m.u,
              2000.0 * std::hypot(0.5 * std::sqrt(2.0) / 500.0, 4e-4), 1e-9);
  const core::Estimate error =
      CheckError(scale, {{0.0, 0.0}, {200.0, 0.0}, 0.5}, {0.101, 0.0});
  EXPECT_NEAR(error.value, -0.001, 1e-12);
  EXPECT_NEAR(
      error.u,
      0.1 * std::hypot(0.5 * std::sqrt(2.0) / 200.0, scale.px_per_m.u / 2000.0),
      1e-12);
}

// A rule near the picture's border, seen through a lens: without it the scale
// is wrong by far more than its u, with it right.
TEST(MeasureScale, UndoesTheLens) {
  const Lens lens = board_picture::TestLens();
  const core::PixelPoint a = Distort(lens, {20.0, 30.0});
  const core::PixelPoint b = Distort(lens, {620.0, 30.0});
  const core::Estimate length{0.6, 1e-6};
  const auto plain = MeasureScale({a, b, 0.1}, length);
  const auto undone = MeasureScale({a, b, 0.1}, length, lens);
  EXPECT_GT(std::abs(plain.px_per_m.value - 1000.0), 20.0 * plain.px_per_m.u);
  EXPECT_NEAR(undone.px_per_m.value, 1000.0, 1e-6);
}

TEST(MeasureScale, RefusesImpossibleArguments) {
  EXPECT_THROW(MeasureScale({{1.0, 1.0}, {1.0, 1.0}}, {1.0, 0.0}),
               std::invalid_argument);
  EXPECT_THROW(MeasureScale({{1.0, 1.0}, {2.0, 1.0}}, {0.0, 0.0}),
               std::invalid_argument);
}

// A camera rolled by 2 degrees: a level ground and the plumb line turn alike; a
// ground that rises by 1 degree to the right turns against the picture's y.
TEST(MeasureSlope, IsOfTheGroundNotOfTheCamera) {
  const double roll = 2.0 * core::kDegree;
  const auto from = [](double angle) {
    return MarkedPair{
        {300.0, 200.0},
        {300.0 + 400.0 * std::cos(angle), 200.0 + 400.0 * std::sin(angle)},
        0.5};
  };
  const MarkedPair plumb = from(roll + 90.0 * core::kDegree);
  const core::Estimate level = MeasureSlope(from(roll), plumb);
  EXPECT_NEAR(level.value, 0.0, 1e-12);
  EXPECT_NEAR(level.u, 0.5 * std::sqrt(2.0) / 400.0 * std::sqrt(2.0), 1e-9);
  const core::Estimate rising =
      MeasureSlope(from(roll - 1.0 * core::kDegree), plumb);
  EXPECT_NEAR(rising.value, 1.0 * core::kDegree, 1e-12);
  // Whichever end is named first.
  const MarkedPair reversed{plumb.p2, plumb.p1, 0.5};
  EXPECT_NEAR(MeasureSlope(from(roll - 1.0 * core::kDegree), reversed).value,
              1.0 * core::kDegree, 1e-12);
}

// A board flat on the ground, seen by a camera that looks down by 25 degrees
// and is turned by 4: the errors over their stated u are standard normal.
TEST(LocateBoard, FindsYawPitchScaleAndLine) {
  const Lens lens = board_picture::TestLens();
  const Board board{BoardKind::kChessboard, 9, 6, 0.025};
  const double yaw = 4.0 * core::kDegree;
  const double pitch = 25.0 * core::kDegree;
  board_picture::BoardPose pose;
  // Board: x along travel, y towards the camera, its normal down. Turned about
  // the ground's normal, then seen by the camera that looks down.
  Eigen::Matrix3d flat;
  flat << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  pose.turn =
      Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()).toRotationMatrix() *
      Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitY()).toRotationMatrix() *
      flat;
  pose.shift = {-0.1, 0.05, 0.6};
  const auto exact = board_picture::Seen(board, pose, lens);
  constexpr int kSets = 60;
  std::vector<double> z_yaw;
  std::vector<double> z_pitch;
  const double truth_yaw = std::asin(pose.turn(2, 0));
  EXPECT_NEAR(truth_yaw, yaw * std::cos(pitch), 0.01);
  double scale_mean = 0.0;
  for (int set = 0; set < kSets; ++set) {
    std::mt19937_64 engine(static_cast<std::uint64_t>(set));
    std::normal_distribution<double> normal(0.0, 0.1);
    auto points = exact;
    for (core::PixelPoint& p : points) {
      p.x_px += normal(engine);
      p.y_px += normal(engine);
    }
    const auto located = LocateBoard(points, board, lens);
    ASSERT_TRUE(located) << located.error().reason;
    ASSERT_TRUE(located->ground.yaw_rad);
    z_yaw.push_back((located->ground.yaw_rad->value - truth_yaw) /
                    located->ground.yaw_rad->u);
    z_pitch.push_back((located->pitch_rad.value - pitch) /
                      located->pitch_rad.u);
    scale_mean += located->px_per_m.value / kSets;
  }
  const auto band = testing::RmsBand9999(kSets);
  EXPECT_GT(testing::Rms(z_yaw), band.low);
  EXPECT_LT(testing::Rms(z_yaw), band.high);
  EXPECT_GT(testing::Rms(z_pitch), band.low);
  EXPECT_LT(testing::Rms(z_pitch), band.high);
  // The middle row's two ends, in the ideal picture.
  const double f = IdealFocal(lens);
  std::vector<Eigen::Vector2d> ends;
  for (const double x : {0.0, 0.2}) {
    const Eigen::Vector3d c =
        pose.turn * Eigen::Vector3d(x, 0.0625, 0.0) + pose.shift;
    ends.emplace_back(f * c.x() / c.z(), f * c.y() / c.z());
  }
  EXPECT_NEAR(scale_mean, (ends[1] - ends[0]).norm() / 0.2, 0.5);
}

}  // namespace
}  // namespace touchdown::calib
