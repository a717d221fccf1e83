#include "app/text/number_row.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace touchdown::report {
namespace {

TEST(NumberRow, HasBlanksBetween) {
  NumberRow row;
  row.AddWhole(-7).AddShortest(0.056).AddFixed(2.5, 1).AddGeneral(1e-7, 3);
  row.AddWord("null");
  EXPECT_EQ(row.text(), "-7 0.056 2.5 1e-07 null");
}

// Oracle: fmt, which wrote these rows before.
TEST(NumberRow, WritesAsFmtDoes) {
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> mantissa(-10.0, 10.0);
  std::uniform_int_distribution<int> power(-12, 12);
  for (int i = 0; i < 2000; ++i) {
    const double value = mantissa(engine) * std::pow(10.0, power(engine));
    NumberRow row;
    row.AddShortest(value).AddFixed(value, 5).AddGeneral(value, 4);
    EXPECT_EQ(row.text(), fmt::format("{} {:.5f} {:.4g}", value, value, value));
  }
  constexpr double kGreatest = std::numeric_limits<double>::max();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double value : {0.0, -0.0, 1.0, 0.5, 1e5, kGreatest, kNan}) {
    NumberRow row;
    row.AddFixed(value, 12).AddGeneral(value, 7);
    EXPECT_EQ(row.text(), fmt::format("{:.12f} {:.7g}", value, value));
  }
}

}  // namespace
}  // namespace touchdown::report
