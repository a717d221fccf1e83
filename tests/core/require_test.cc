#include "touchdown/core/require.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

namespace touchdown::core {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr double kEndless = std::numeric_limits<double>::infinity();

std::string Said(const std::function<void()>& check) {
  try {
    check();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "nothing";
}

TEST(Require, SaysFieldValueUnitAndRange) {
  EXPECT_EQ(Said([] { RequirePositive("diameter", -0.04, "m"); }),
            "diameter is -0.04 m, must be positive and finite");
  EXPECT_EQ(Said([] { RequireNotNegative("u", -1.0); }),
            "u is -1, must be at least 0 and finite");
  EXPECT_EQ(Said([] { RequireInRange("p", 1.5, 0.0, 1.0); }),
            "p is 1.5, must be from 0 to 1");
  EXPECT_EQ(Said([] { Require(false, "levels", 3, "at least 4"); }),
            "levels is 3, must be at least 4");
  // The digits that give the number again.
  EXPECT_EQ(Said([] { Refuse("x", 0.1 + 0.2, "smaller"); }),
            "x is 0.30000000000000004, must be smaller");
}

TEST(Require, TakesTheEndsOfARange) {
  EXPECT_EQ(Said([] { RequireInRange("p", 0.0, 0.0, 1.0); }), "nothing");
  EXPECT_EQ(Said([] { RequireInRange("p", 1.0, 0.0, 1.0); }), "nothing");
  EXPECT_EQ(Said([] { RequireNotNegative("u", 0.0); }), "nothing");
  EXPECT_NE(Said([] { RequirePositive("u", 0.0); }), "nothing");
}

TEST(Require, RefusesWhatIsNoNumber) {
  for (const double value : {kNothing, kEndless, -kEndless}) {
    EXPECT_NE(Said([&] { RequireFinite("x", value); }), "nothing");
    EXPECT_NE(Said([&] { RequirePositive("x", value); }), "nothing");
    EXPECT_NE(Said([&] { RequireNotNegative("x", value); }), "nothing");
    EXPECT_NE(Said([&] { RequireInRange("x", value, 0.0, 1.0); }), "nothing");
  }
}

}  // namespace
}  // namespace touchdown::core
