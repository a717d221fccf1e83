#include "vision/src/tracking/best_outline.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchdown::vision {
namespace {

CoMoving Silent(int half) {
  CoMoving places;
  places.half = half;
  const auto n = static_cast<std::size_t>(places.size());
  places.says.assign(n * n, 0);
  return places;
}

// `says(x, y)` of each place, from the middle.
template <class Says>
CoMoving Saying(int half, const Says& says) {
  CoMoving places = Silent(half);
  std::size_t i = 0;
  for (int y = -half; y <= half; ++y) {
    for (int x = -half; x <= half; ++x) {
      places.says[i++] = static_cast<signed char>(says(x, y));
    }
  }
  return places;
}

constexpr double kAngle_rad = 0.2;
double Along(int x, int y) {
  return x * std::cos(kAngle_rad) + y * std::sin(kAngle_rad);
}
double Across(int x, int y) {
  return y * std::cos(kAngle_rad) - x * std::sin(kAngle_rad);
}

TEST(FindBestOutline, TwoEndsWithNothingBetweenAreOneBlockWithoutItsPin) {
  const CoMoving places = Saying(60, [](int x, int y) {
    const double u = Along(x, y) - 10.0;
    const double v = Across(x, y);
    const bool end = std::abs(u) < 30.0 && std::abs(u) > 20.0;
    const bool pin = std::abs(u - 25.0) < 2.0 && v < 0.0 && v > -15.0;
    return (end && std::abs(v) < 8.0) || pin ? 1 : 0;
  });
  const auto best = FindBestOutline(places, core::BodyKind::kRectangle, true);
  ASSERT_TRUE(best);
  EXPECT_NEAR(best->outline.half_long_px, 30.0, 0.5);
  EXPECT_NEAR(best->outline.half_short_px, 8.0, 0.5);
  EXPECT_NEAR(best->outline.angle_rad, kAngle_rad, 0.02);
  EXPECT_NEAR(best->outline.centre.x_px, 10.0 * std::cos(kAngle_rad), 0.5);
  EXPECT_NEAR(best->outline.centre.y_px, 10.0 * std::sin(kAngle_rad), 0.5);
  EXPECT_GT(best->holds, 0.9);
  EXPECT_GT(best->pure, 0.99);
}

TEST(FindBestOutline, WhatIsStillIsLeftOut) {
  const CoMoving places = Saying(40, [](int x, int y) {
    if (std::hypot(x - 3, y + 2) < 15.0) return 1;
    return y > 14 ? -1 : 0;
  });
  auto best = FindBestOutline(places, core::BodyKind::kSphere, true);
  ASSERT_TRUE(best);
  EXPECT_NEAR(best->outline.radius_px, 15.0, 0.8);
  EXPECT_NEAR(best->outline.centre.x_px, 3.0, 0.5);
  EXPECT_NEAR(best->outline.centre.y_px, -2.0, 0.5);
  const auto box = FindBestOutline(places, core::BodyKind::kRectangle, true);
  ASSERT_TRUE(box);
  EXPECT_LT(box->merit, best->merit);
}

TEST(FindBestOutline, PlacesMayBeFarApart) {
  CoMoving places =
      Saying(40, [](int x, int y) { return std::hypot(x, y) < 15.0 ? 1 : 0; });
  places.spacing_px = 3.0;
  const auto best = FindBestOutline(places, core::BodyKind::kSphere, false);
  ASSERT_TRUE(best);
  EXPECT_NEAR(best->outline.radius_px, 45.0, 3.0);
}

TEST(FindBestOutline, NothingOfFewPlaces) {
  EXPECT_FALSE(FindBestOutline(Silent(20), core::BodyKind::kSphere, true));
}

}  // namespace
}  // namespace touchdown::vision
