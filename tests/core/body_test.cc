#include "touchdown/core/body.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "touchdown/core/units.h"

namespace touchdown::core {
namespace {

using literals::operator""_mm;

TEST(Sphere, HasADiameterAndNoSides) {
  const Body body = Sphere({40.0_mm, 0.02_mm});
  ASSERT_TRUE(body.diameter_m.has_value());
  EXPECT_DOUBLE_EQ(body.diameter_m->value, 0.040);
  EXPECT_EQ(body.long_m.error().reason, "not a rectangle");
  EXPECT_DOUBLE_EQ(Size(body)->value, 0.040);
}

TEST(Sphere, RefusesImpossibleDiametersByName) {
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    try {
      Sphere({bad, 0.0});
      ADD_FAILURE() << "accepted " << bad;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("diameter"));
    }
  }
  EXPECT_THROW(Sphere({0.04, -1e-6}), std::invalid_argument);
}

TEST(Rectangle, PutsTheLongSideFirst) {
  const Body body = Rectangle({20.0_mm, 0.0}, {60.0_mm, 0.0});
  EXPECT_DOUBLE_EQ(body.long_m->value, 0.060);
  EXPECT_DOUBLE_EQ(body.short_m->value, 0.020);
  EXPECT_DOUBLE_EQ(Size(body)->value, 0.060);
}

TEST(UnmeasuredBody, NamesTheReasonForTheSizesOfItsKindOnly) {
  const Body sphere = UnmeasuredBody(BodyKind::kSphere);
  EXPECT_EQ(sphere.diameter_m.error().reason, "not recorded");
  EXPECT_EQ(sphere.long_m.error().reason, "not a rectangle");
  const Body block = UnmeasuredBody(BodyKind::kRectangle, "lost");
  EXPECT_EQ(block.kind, BodyKind::kRectangle);
  EXPECT_EQ(block.diameter_m.error().reason, "not a sphere");
  EXPECT_EQ(block.long_m.error().reason, "lost");
  EXPECT_EQ(block.short_m.error().reason, "lost");
}

TEST(DefaultBounceHeight, IsTheLargerOfHalfAMillimetreAndTwoPercent) {
  EXPECT_DOUBLE_EQ(DefaultBounceHeight(10.0_mm), 0.5_mm);
  EXPECT_DOUBLE_EQ(DefaultBounceHeight(25.0_mm), 0.5_mm);
  EXPECT_DOUBLE_EQ(DefaultBounceHeight(100.0_mm), 2.0_mm);
  EXPECT_THROW(DefaultBounceHeight(0.0), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::core
