#include "touchdown/analysis/statistics/control_chart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <vector>

namespace touchdown::analysis {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// NIST/SEMATECH e-Handbook, 6.3.2.2: ten batches of a process, mean 50.81, mean
// moving range 1.8778, limits 45.8159 and 55.8041.
TEST(ChartIndividuals, IsTheHandbooksExample) {
  const std::vector<double> flow = {49.6, 47.6, 49.9, 51.3, 47.8,
                                    51.2, 52.6, 52.4, 53.6, 52.1};
  const auto chart = ChartIndividuals(flow);
  ASSERT_TRUE(chart);
  EXPECT_NEAR(chart->centre, 50.81, 1e-9);
  EXPECT_NEAR(chart->mean_range, 1.8778, 5e-5);
  EXPECT_NEAR(chart->lower, 45.8159, 5e-5);
  EXPECT_NEAR(chart->upper, 55.8041, 5e-5);
  EXPECT_THAT(chart->beyond, IsEmpty());
  EXPECT_TRUE(chart->provisional);
}

TEST(ChartIndividuals, NamesWhatLiesBeyondTheLimits) {
  std::vector<double> values;
  for (int i = 0; i < 30; ++i) values.push_back(i % 2 == 0 ? 1.0 : 1.1);
  values[17] = 2.0;
  const auto chart = ChartIndividuals(values);
  ASSERT_TRUE(chart);
  EXPECT_THAT(chart->beyond, ElementsAre(17u));
  EXPECT_FALSE(chart->provisional);
}

TEST(ChartIndividuals, OneValueHasNoLimits) {
  EXPECT_FALSE(ChartIndividuals({}));
  EXPECT_FALSE(ChartIndividuals(std::vector{1.0}));
  EXPECT_THROW(ChartIndividuals(
                   std::vector{1.0, std::numeric_limits<double>::infinity()}),
               std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::analysis
