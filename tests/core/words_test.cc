#include "touchdown/core/words.h"

#include <gtest/gtest.h>

namespace touchdown::core {
namespace {

// Property: every word parses back to what it names, and nothing else does.
TEST(Words, ParseInvertsName) {
  for (const auto k : {BodyKind::kSphere, BodyKind::kRectangle})
    EXPECT_EQ(ParseBodyKind(Name(k)), k);
  for (const auto k :
       {AngleKind::kApproach, AngleKind::kRadius, AngleKind::kFace})
    EXPECT_EQ(ParseAngleKind(Name(k)), k);
  for (const auto k : {Corner::kLeading, Corner::kTrailing, Corner::kFlush})
    EXPECT_EQ(ParseCorner(Name(k)), k);
  for (const auto k :
       {MotionState::kBounce, MotionState::kSlide, MotionState::kRollSlide,
        MotionState::kRoll, MotionState::kStick, MotionState::kStaysDown,
        MotionState::kUndecided})
    EXPECT_EQ(ParseMotionState(Name(k)), k);
  for (const auto k : {Origin::kRecorded, Origin::kSimulated, Origin::kManual})
    EXPECT_EQ(ParseOrigin(Name(k)), k);
  EXPECT_EQ(ParseBodyKind("cube"), std::nullopt);
  EXPECT_EQ(ParseMotionState(""), std::nullopt);
}

TEST(IsNotBounce, LeavesUndecidedOut) {
  EXPECT_FALSE(IsNotBounce(MotionState::kBounce));
  EXPECT_FALSE(IsNotBounce(MotionState::kUndecided));
  EXPECT_TRUE(IsNotBounce(MotionState::kStaysDown));
  EXPECT_TRUE(IsNotBounce(MotionState::kRoll));
}

}  // namespace
}  // namespace touchdown::core
