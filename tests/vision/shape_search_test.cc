#include "vision/src/detection/shape_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace touchdown::vision {
namespace {

constexpr std::int32_t kWidth = 90;
constexpr std::int32_t kHeight = 60;
constexpr double kDegree = std::numbers::pi / 180.0;

// 1 inside of the shape at `at`, 0 elsewhere.
std::vector<float> DrawChange(const KnownShape& shape, const PlacedShape& at) {
  std::vector<float> change;
  const double cosine = std::cos(at.angle_rad);
  const double sine = std::sin(at.angle_rad);
  for (std::int32_t y = 0; y < kHeight; ++y) {
    for (std::int32_t x = 0; x < kWidth; ++x) {
      const double dx = x - at.centre.x_px;
      const double dy = y - at.centre.y_px;
      const bool inside =
          shape.kind == core::BodyKind::kSphere
              ? std::hypot(dx, dy) < 0.5 * shape.long_side
              : std::abs(cosine * dx + sine * dy) < 0.5 * shape.long_side &&
                    std::abs(-sine * dx + cosine * dy) < 0.5 * shape.short_side;
      change.push_back(inside ? 1.0F : 0.0F);
    }
  }
  return change;
}

TEST(ShapeSearch, FindsARectangleAtAnyAngle) {
  const KnownShape shape{core::BodyKind::kRectangle, 20.0, 7.0};
  const ShapeSearch search(shape, kWidth, kHeight);
  for (const double angle_deg : {0.0, 13.0, 47.0, 90.0, 128.0, 175.0}) {
    const PlacedShape truth{{38.3, 27.6}, angle_deg * kDegree, 1.0};
    const auto found = search.FindMaxima(DrawChange(shape, truth), 6);
    ASSERT_FALSE(found.empty()) << angle_deg;
    EXPECT_NEAR(found.front().centre.x_px, truth.centre.x_px, 0.6) << angle_deg;
    EXPECT_NEAR(found.front().centre.y_px, truth.centre.y_px, 0.6) << angle_deg;
    EXPECT_NEAR(std::remainder(found.front().angle_rad - truth.angle_rad,
                               std::numbers::pi),
                0.0, 4.0 * kDegree)
        << angle_deg;
    EXPECT_GT(found.front().score, 0.85) << angle_deg;
  }
}

TEST(ShapeSearch, FindsADiscPartlyOutsideOfThePicture) {
  const KnownShape shape{core::BodyKind::kSphere, 14.0, 14.0};
  const ShapeSearch search(shape, kWidth, kHeight);
  const PlacedShape truth{{1.0, 30.0}, 0.0, 1.0};
  const auto found = search.FindMaxima(DrawChange(shape, truth), 3);
  ASSERT_FALSE(found.empty());
  // What the picture cuts off counts as unchanged, so that the score is flat
  // across the border.
  EXPECT_NEAR(found.front().centre.x_px, 1.0, 1.5);
  EXPECT_NEAR(found.front().centre.y_px, 30.0, 0.6);
  EXPECT_NEAR(found.front().score, 0.6, 0.1);
  EXPECT_EQ(found.front().angle_rad, 0.0);
}

TEST(ShapeSearch, KeepsTwoPlacesApart) {
  const KnownShape shape{core::BodyKind::kSphere, 12.0, 12.0};
  const ShapeSearch search(shape, kWidth, kHeight);
  std::vector<float> change = DrawChange(shape, {{20.0, 20.0}, 0.0, 1.0});
  const auto other = DrawChange(shape, {{60.0, 40.0}, 0.0, 1.0});
  for (std::size_t i = 0; i < change.size(); ++i) {
    change[i] = std::max(change[i], 0.7F * other[i]);
  }
  const auto found = search.FindMaxima(change, 60);
  EXPECT_NEAR(found.front().centre.x_px, 20.0, 0.6);
  EXPECT_TRUE(std::any_of(found.begin(), found.end(), [](const auto& place) {
    return std::hypot(place.centre.x_px - 60.0, place.centre.y_px - 40.0) < 1.0;
  }));
}

TEST(ShapeSearch, FindsNothingWhereNothingChanged) {
  const ShapeSearch search({core::BodyKind::kRectangle, 20.0, 7.0}, kWidth,
                           kHeight);
  EXPECT_TRUE(
      search.FindMaxima(std::vector<float>(kWidth * kHeight, 0.0F), 6).empty());
}

TEST(ShapeSearch, RefusesWhatHasNoSize) {
  const KnownShape flat{core::BodyKind::kRectangle, 20.0, 0.0};
  EXPECT_THROW(ShapeSearch(flat, kWidth, kHeight), std::invalid_argument);
  const KnownShape disc{core::BodyKind::kSphere, 5.0, 5.0};
  EXPECT_THROW(ShapeSearch(disc, 0, kHeight), std::invalid_argument);
  const ShapeSearch search(disc, kWidth, kHeight);
  EXPECT_THROW(search.FindMaxima(std::vector<float>(7, 0.0F), 6),
               std::invalid_argument);
}

TEST(SymmetryPeriod, IsAQuarterTurnForSquares) {
  EXPECT_DOUBLE_EQ(SymmetryPeriod({core::BodyKind::kRectangle, 20.0, 7.0}),
                   std::numbers::pi);
  EXPECT_DOUBLE_EQ(SymmetryPeriod({core::BodyKind::kRectangle, 20.0, 19.9}),
                   0.5 * std::numbers::pi);
}

}  // namespace
}  // namespace touchdown::vision
