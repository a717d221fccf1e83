#include "touchdown/calib/lens.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/calib/board_picture.h"

namespace touchdown::calib {
namespace {

// Closed form: on the x axis through the centre, with k1 alone,
// x_d = x (1 + k1 x^2).
TEST(Lens, FollowsBrownOnTheAxis) {
  Lens lens{1000.0, 1000.0, 320.0, 240.0, -0.2, 0.0, 0.0, 0.0, 0.0};
  const auto seen = Distort(lens, {320.0 + 300.0, 240.0});
  EXPECT_NEAR(seen.x_px, 320.0 + 300.0 * (1.0 - 0.2 * 0.09), 1e-9);
  EXPECT_DOUBLE_EQ(seen.y_px, 240.0);
  // Decentring alone, at (x, y) = (0.1, 0.2): 2 p1 x y and p1 (r^2 + 2 y^2).
  lens.k1 = 0.0;
  lens.p1 = 0.01;
  const auto shifted = Distort(lens, {420.0, 440.0});
  EXPECT_NEAR(shifted.x_px, 420.0 + 1000.0 * 2.0 * 0.01 * 0.02, 1e-9);
  EXPECT_NEAR(shifted.y_px, 440.0 + 1000.0 * 0.01 * (0.05 + 0.08), 1e-9);
}

TEST(Lens, UndistortIsTheInverseWithItsJacobian) {
  const Lens lens = board_picture::TestLens();
  for (double x = -0.5; x < 640.0; x += 53.3) {
    for (double y = -0.5; y < 480.0; y += 47.9) {
      const auto ideal = Undistort(lens, {x, y});
      ASSERT_TRUE(ideal) << x << ", " << y;
      const auto back = Distort(lens, ideal->point);
      EXPECT_NEAR(back.x_px, x, 1e-9);
      EXPECT_NEAR(back.y_px, y, 1e-9);
      constexpr double kStep = 1e-3;
      const auto right = Undistort(lens, {x + kStep, y});
      const auto left = Undistort(lens, {x - kStep, y});
      const auto down = Undistort(lens, {x, y + kStep});
      const auto up = Undistort(lens, {x, y - kStep});
      ASSERT_TRUE(right && left && down && up);
      const auto slope = [&](double a, double b) {
        return (a - b) / (2.0 * kStep);
      };
      EXPECT_NEAR(ideal->jacobian(0, 0),
                  slope(right->point.x_px, left->point.x_px), 1e-6);
      EXPECT_NEAR(ideal->jacobian(1, 0),
                  slope(right->point.y_px, left->point.y_px), 1e-6);
      EXPECT_NEAR(ideal->jacobian(0, 1),
                  slope(down->point.x_px, up->point.x_px), 1e-6);
      EXPECT_NEAR(ideal->jacobian(1, 1),
                  slope(down->point.y_px, up->point.y_px), 1e-6);
    }
  }
}

// r (1 + k1 r^2) with k1 = -0.2 has its maximum, 0.861, at r = 1.29.
TEST(Lens, SaysWhereTheModelFoldsBack) {
  const Lens lens{600.0, 600.0, 320.0, 240.0, -0.2, 0.0, 0.0, 0.0, 0.0};
  EXPECT_TRUE(IsInvertible(lens, 640, 480));
  EXPECT_FALSE(IsInvertible(lens, 1280, 960));
  EXPECT_FALSE(Undistort(lens, {320.0 + 600.0 * 0.87, 240.0}));
  EXPECT_TRUE(Undistort(lens, {320.0 + 600.0 * 0.85, 240.0}));
}

TEST(Lens, ACropSeesTheSame) {
  const Lens lens = board_picture::TestLens();
  const Lens part = Cropped(lens, 100.0, 64.0);
  const auto whole = Undistort(lens, {512.25, 401.5});
  const auto of_part = Undistort(part, {412.25, 337.5});
  ASSERT_TRUE(whole && of_part);
  EXPECT_NEAR(of_part->point.x_px + 100.0, whole->point.x_px, 1e-9);
  EXPECT_NEAR(of_part->point.y_px + 64.0, whole->point.y_px, 1e-9);
}

TEST(Lens, IsAVectorAndBack) {
  const Lens lens = board_picture::TestLens();
  EXPECT_EQ(ToLens(ToVector(lens)), lens);
}

TEST(Lens, LargestDisplacementIsAtACorner) {
  const Lens lens{1000.0, 1000.0, 319.5, 239.5, -0.1, 0.0, 0.0, 0.0, 0.0};
  const auto corner = Undistort(lens, {-0.5, -0.5});
  ASSERT_TRUE(corner);
  EXPECT_NEAR(LargestDisplacement(lens, 640, 480),
              std::hypot(corner->point.x_px + 0.5, corner->point.y_px + 0.5),
              1e-9);
}

}  // namespace
}  // namespace touchdown::calib
