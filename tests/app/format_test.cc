#include "app/text/format.h"

#include <gtest/gtest.h>

namespace touchdown::report {
namespace {

TEST(WithU, TwoDigitsOfTheUncertainty) {
  EXPECT_EQ(WithU({20.0134, 0.0483, {}}, 1.0), "20.013 \u00b1 0.048");
  EXPECT_EQ(WithU({20.0134, 4.83, {}}, 1.0), "20.0 \u00b1 4.8");
  EXPECT_EQ(WithU({2013.4, 48.3, {}}, 1.0), "2013 \u00b1 48");
  EXPECT_EQ(WithU({0.0134, 0.00005, {}}, 1e-3), "13.400 \u00b1 0.050");
  EXPECT_EQ(WithU({11.8, 0.0, {}}, 1.0), "11.8");
  // 0.0996 rounds up to 0.10; a small u never reads as none.
  EXPECT_EQ(WithU({1.0, 0.0996, {}}, 1.0), "1.00 \u00b1 0.10");
  EXPECT_EQ(WithU({0.88, 1.2e-8, {}}, 1.0), "0.880000000 \u00b1 0.000000012");
  // A value that rounds to nothing has no sign.
  EXPECT_EQ(WithU({-0.0001, 0.048, {}}, 1.0), "0.000 \u00b1 0.048");
}

TEST(DifferenceWithU, HasItsSign) {
  EXPECT_EQ(DifferenceWithU({0.0134, 0.048, {}}, 1.0), "+0.013 \u00b1 0.048");
  EXPECT_EQ(DifferenceWithU({-0.0134, 0.048, {}}, 1.0), "-0.013 \u00b1 0.048");
  EXPECT_EQ(DifferenceWithU({0.0001, 0.048, {}}, 1.0), "0.000 \u00b1 0.048");
}

TEST(Signed, NoZeroHasASign) {
  EXPECT_EQ(Signed(1.234, 2), "+1.23");
  EXPECT_EQ(Signed(-1.234, 2), "-1.23");
  EXPECT_EQ(Signed(-0.004, 2), "0.00");
  EXPECT_EQ(Signed(0.004, 2), "0.00");
}

TEST(Probability, ClaimsNoCertainty) {
  EXPECT_EQ(Probability(0.0), "< 0.001");
  EXPECT_EQ(Probability(0.0004), "< 0.001");
  EXPECT_EQ(Probability(0.5), "0.500");
  EXPECT_EQ(Probability(0.99951), "> 0.999");
  EXPECT_EQ(Probability(1.0), "> 0.999");
}

TEST(InAscii, ForTerminals) {
  EXPECT_EQ(InAscii(WithU({20.0134, 0.0483, {}}, 1.0)), "20.013 +- 0.048");
}

TEST(WithUOrReason, SaysWhyThereIsNone) {
  EXPECT_EQ(WithUOrReason(core::AbsentBecause("no mark"), 1.0),
            "absent: no mark");
}

TEST(Plain, NoTrailingZerosNoNegativeZero) {
  EXPECT_EQ(Plain(43.0), "43");
  EXPECT_EQ(Plain(11.80), "11.8");
  EXPECT_EQ(Plain(-0.001), "0");
  EXPECT_EQ(Plain(100.0, 0), "100");
}

TEST(HalfOpen, EveryCombinationOfEnds) {
  EXPECT_EQ(HalfOpen(11.8, 27.4, 1.0), "[11.8, 27.4)");
  EXPECT_EQ(HalfOpen(11.8, {}, 1.0), "from 11.8 on");
  EXPECT_EQ(HalfOpen({}, 27.4, 1.0), "below 27.4");
  EXPECT_EQ(HalfOpen({}, {}, 1.0), "anywhere");
}

}  // namespace
}  // namespace touchdown::report
