#include "touchdown/analysis/theory/regime_map.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchdown::analysis {
namespace {

TEST(ComputeRegimeMap, CellsAreTheContactProblem) {
  RegimeMapOptions options;
  options.axis = MapAxis::kOmega;
  options.axis_max = 40.0;
  options.alpha_points = 31;
  options.axis_points = 17;
  options.problem.mu = 1.6;
  options.problem.slip = Slip::kLeading;
  options.problem.radius_m = 0.05;
  const RegimeMap map = ComputeRegimeMap(options);
  ASSERT_EQ(map.alpha_rad.size(), 31u);
  ASSERT_EQ(map.axis_value.size(), 17u);
  EXPECT_EQ(map.axis_value.back(), 40.0);
  int detaching = 0;
  for (std::size_t j = 0; j < map.axis_value.size(); ++j) {
    for (std::size_t i = 0; i < map.alpha_rad.size(); ++i) {
      ContactProblem p = options.problem;
      p.alpha = RoundedSinCosOfRadians(map.alpha_rad[i]);
      p.omega_rad_per_s = map.axis_value[j];
      EXPECT_EQ(map.At(i, j).regime, SolveContact(p).tolerant_regime);
      detaching += map.At(i, j).regime == Regime::kDetach;
    }
  }
  EXPECT_GT(detaching, 10);
}

TEST(ComplementarityLines, MeetTheAxesWhereTheSolutionIs) {
  ContactProblem p{
      .alpha = {}, .mu = 0.5, .slip = Slip::kTrailing, .radius_m = 0.05};
  const auto lines = ComplementarityLines(p, {0.2, 0.8});
  ASSERT_EQ(lines.size(), 2u);
  for (const auto& line : lines) {
    EXPECT_EQ(line.regime, Regime::kSlide);
    EXPECT_EQ(line.intercept, -1.0);
    p.alpha = RoundedSinCosOfRadians(line.alpha_rad);
    EXPECT_NEAR(-line.intercept / line.slope * p.gravity_mps2,
                SolveSlidingContact(p).normal_per_mass_mps2, 1e-14);
  }
}

TEST(ComputeRegimeMap, RefusesWhatCannotBe) {
  RegimeMapOptions options;
  options.problem.radius_m = 0.05;
  options.alpha_points = 1;
  EXPECT_THROW(ComputeRegimeMap(options), std::invalid_argument);
  options.alpha_points = 10;
  options.problem.slip = Slip::kNone;
  EXPECT_THROW(ComputeRegimeMap(options), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::analysis
