#include "touchdown/analysis/statistics/set_angles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "touchdown/analysis/statistics/boundary_fit.h"
#include "touchdown/analysis/statistics/paper_table1.h"
#include "touchdown/core/units.h"

namespace touchdown::analysis {
namespace {

using core::kDegree;

Observation Set(double set_deg, double seen_deg, double u_deg, bool bounced) {
  Observation out = Observe(seen_deg * kDegree, u_deg * kDegree, bounced);
  out.set_angle_rad = set_deg * kDegree;
  return out;
}

TEST(UseSetAngles, LeavesAloneWhatDoesNotRepeat) {
  std::vector<Observation> trials{Set(5, 5.3, 0.3, false),
                                  Set(6, 5.8, 0.3, true),
                                  Observe(6 * kDegree, 0.3 * kDegree, 1.0)};
  const SetAngleUse use = UseSetAngles(trials);
  EXPECT_EQ(use.repeated, 0);
  EXPECT_FALSE(use.set_u_rad.has_value());
  for (std::size_t i = 0; i < trials.size(); ++i) {
    EXPECT_EQ(use.observations[i].angle_rad, trials[i].angle_rad);
    EXPECT_EQ(use.observations[i].u_rad, trials[i].u_rad);
  }
}

TEST(UseSetAngles, LeavesAloneWhatWasTyped) {
  const auto table1 = PaperTable1(core::BodyKind::kSphere, 0.5 * kDegree);
  std::vector<Observation> twice = table1;
  twice.insert(twice.end(), table1.begin(), table1.end());
  EXPECT_EQ(UseSetAngles(twice).repeated, 0);
}

// With the belief switched off: k and u' of the header, by hand. Deviations
// +-0.5 and +-0.5 at two set angles: (4 x 0.25 - 4 x 0.09 / 2) / 2 = 0.41.
TEST(UseSetAngles, DrawsRepeatsTowardsTheirMean) {
  const std::vector<Observation> trials{
      Set(10, 10.7, 0.3, true), Set(10, 9.7, 0.3, false),
      Set(14, 14.5, 0.3, true), Set(14, 13.5, 0.3, true)};
  const SetAngleUse use = UseSetAngles(trials, {0.5 * kDegree, 0.0});
  EXPECT_EQ(use.repeated, 4);
  ASSERT_TRUE(use.set_u_rad.has_value());
  EXPECT_NEAR(*use.set_u_rad / kDegree, std::sqrt(0.41), 1e-9);
  const double k = 0.41 / 0.50;
  EXPECT_NEAR(use.observations[0].angle_rad / kDegree, 10.2 + k * 0.5, 1e-9);
  EXPECT_NEAR(use.observations[3].angle_rad / kDegree, 14.0 - k * 0.5, 1e-9);
  EXPECT_NEAR(use.observations[1].u_rad / kDegree,
              std::sqrt(k * 0.09 + (1 - k) * (1 - k) * 0.50 / 2), 1e-9);
}

// Trials of two set-ups at one set angle are two sets of repeats.
TEST(UseSetAngles, KeepsSetUpsApart) {
  std::vector<Observation> trials{Set(10, 10.7, 0.3, true),
                                  Set(10, 9.7, 0.3, false)};
  trials[1].setup = 1;
  EXPECT_EQ(UseSetAngles(trials).repeated, 0);
}

// All trials at one set angle, boundary 0.9 deg above it: taken at their word
// the measured angles put it farther off.
TEST(UseSetAngles, UndoesTheBiasOfRepeats) {
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal;
  std::vector<Observation> trials;
  for (int i = 0; i < 4000; ++i) {
    const double x = 20.0 + 0.5 * normal(engine);
    const bool bounced = x > 20.9;
    trials.push_back(Set(20.0, x + 0.3 * normal(engine), 0.3, bounced));
  }
  BoundaryFitOptions fit;
  fit.sensitivity.clear();
  fit.bin_above = trials.size();
  const double as_measured = FitBoundary(trials, fit).median_rad / kDegree;
  const double used =
      FitBoundary(UseSetAngles(trials).observations, fit).median_rad / kDegree;
  EXPECT_GT(as_measured, 21.05);
  EXPECT_NEAR(used, 20.9, 0.06);
}

TEST(UseSetAngles, RefusesWhatCannotBe) {
  EXPECT_THROW(UseSetAngles({}, {-1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::analysis
