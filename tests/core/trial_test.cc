#include "touchdown/core/trial.h"

#include <gtest/gtest.h>

namespace touchdown::core {
namespace {

Trial WithFaceAngle(Estimate face) {
  Trial trial;
  trial.angle_kind = AngleKind::kFace;
  trial.first.contact.face_angle_rad = face;
  return trial;
}

TEST(ContactAngle, OfAFaceIsTheMagnitudeWhicheverEndIsUp) {
  for (const double sign : {1.0, -1.0}) {
    const Measured angle =
        ContactAngle(WithFaceAngle({sign * 0.4, 0.01, std::nullopt}));
    ASSERT_TRUE(angle);
    EXPECT_DOUBLE_EQ(angle->value, 0.4) << sign;
    EXPECT_DOUBLE_EQ(angle->u, 0.01) << sign;
  }
}

TEST(ContactAngle, TurnsTheIntervalOverWithTheAngle) {
  const Measured angle =
      ContactAngle(WithFaceAngle({-0.4, 0.02, Interval{-0.47, -0.36}}));
  ASSERT_TRUE(angle->interval95);
  EXPECT_DOUBLE_EQ(angle->interval95->low, 0.36);
  EXPECT_DOUBLE_EQ(angle->interval95->high, 0.47);
}

TEST(ContactAngle, OfAnotherKindIsAsMeasured) {
  Contact contact;
  contact.approach_angle_rad = Estimate{0.3, 0.01, std::nullopt};
  EXPECT_EQ(ContactAngle(contact, AngleKind::kApproach),
            contact.approach_angle_rad);
  EXPECT_EQ(ContactAngle(contact, AngleKind::kFace), contact.face_angle_rad);
}

}  // namespace
}  // namespace touchdown::core
