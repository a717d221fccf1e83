#include "app/report/format.h"

#include <gtest/gtest.h>

namespace touchdown::report {
namespace {

TEST(WithU, TwoDigitsOfTheUncertainty) {
  EXPECT_EQ(WithU({20.0134, 0.0483, {}}, 1.0), "20.013 \u00b1 0.048");
  EXPECT_EQ(WithU({20.0134, 4.83, {}}, 1.0), "20.0 \u00b1 4.8");
  EXPECT_EQ(WithU({2013.4, 48.3, {}}, 1.0), "2013 \u00b1 48");
  EXPECT_EQ(WithU({0.0134, 0.00005, {}}, 1e-3), "13.400 \u00b1 0.050");
  EXPECT_EQ(WithU({11.8, 0.0, {}}, 1.0), "11.8");
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
