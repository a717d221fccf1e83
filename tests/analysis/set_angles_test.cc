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

// Two set angles of one trial each, r = 0.3 and -0.2, the belief worth four
// trials of 0.25: (4 x 0.25 + 0.125 - 0.09) / 5 = 0.207, by hand.
TEST(UseSetAngles, PoolsSetAnglesThatAgree) {
  const std::vector<Observation> trials{
      Set(5, 5.3, 0.3, false), Set(6, 5.8, 0.3, true),
      Observe(6 * kDegree, 0.3 * kDegree, 1.0)};
  const SetAngleUse use = UseSetAngles(trials);
  EXPECT_EQ(use.used, 2);
  ASSERT_TRUE(use.within_rad && use.between_rad);
  EXPECT_NEAR(*use.within_rad / kDegree, std::sqrt(0.207), 1e-9);
  EXPECT_EQ(*use.between_rad, 0.0);
  const double k = 0.207 / 0.297;
  EXPECT_NEAR(use.observations[0].angle_rad / kDegree, 5.05 + k * 0.25, 1e-9);
  EXPECT_NEAR(use.observations[1].angle_rad / kDegree, 6.05 - k * 0.25, 1e-9);
  EXPECT_NEAR(use.observations[0].u_rad / kDegree,
              std::sqrt(k * 0.09 + (1 - k) * (1 - k) * 0.297 / 2), 1e-9);
  EXPECT_EQ(use.observations[2].angle_rad, trials[2].angle_rad);
  EXPECT_EQ(use.observations[2].u_rad, trials[2].u_rad);
}

// An ejector that does not do what it is told says nothing of the angle.
TEST(UseSetAngles, BelievesMeasuredAnglesWhereTheEjectorDeviates) {
  const std::vector<Observation> trials{
      Set(10, 14, 0.3, false), Set(20, 30, 0.3, true), Set(30, 27, 0.3, true)};
  const SetAngleUse use = UseSetAngles(trials);
  EXPECT_GT(*use.between_rad / kDegree, 3.0);
  for (std::size_t i = 0; i < trials.size(); ++i) {
    EXPECT_NEAR(use.observations[i].angle_rad, trials[i].angle_rad,
                0.1 * trials[i].u_rad);
    EXPECT_NEAR(use.observations[i].u_rad / trials[i].u_rad, 1.0, 0.01);
  }
}

TEST(UseSetAngles, LeavesAloneWhatWasTyped) {
  const auto table1 = PaperTable1(core::BodyKind::kSphere, 0.5 * kDegree);
  EXPECT_EQ(UseSetAngles(table1).used, 0);
  std::vector<Observation> twice = table1;
  twice.insert(twice.end(), table1.begin(), table1.end());
  EXPECT_EQ(UseSetAngles(twice).used, 0);
}

// With the belief switched off, by hand: deviations +-0.5 at two set angles are
// within = (4 x 0.25 - 2 x 0.09) / 2 = 0.41 deg^2, their means 1.6 deg from the
// offset of 1.6 deg between = (4 x 2.56 - 0.09 - 0.41) / 2 = 4.87 deg^2.
TEST(UseSetAngles, DrawsRepeatsTowardsTheirMean) {
  const std::vector<Observation> trials{
      Set(10, 13.7, 0.3, true), Set(10, 12.7, 0.3, false),
      Set(14, 14.5, 0.3, true), Set(14, 13.5, 0.3, true)};
  const SetAngleUse use = UseSetAngles(trials, {0.5 * kDegree, 0.0});
  EXPECT_EQ(use.used, 4);
  EXPECT_NEAR(*use.within_rad / kDegree, std::sqrt(0.41), 1e-9);
  EXPECT_NEAR(*use.between_rad / kDegree, std::sqrt(4.87), 1e-9);
  const double k = 0.41 / 0.50;
  const double b = 4.87 / (4.87 + 0.25);
  const double mean = 1.6 * (1 + b);
  const double variance = b * 0.25 + (1 - b) * (1 - b) * (4.87 + 0.25) / 2;
  EXPECT_NEAR(use.observations[0].angle_rad / kDegree,
              10 + mean + k * (3.7 - mean), 1e-9);
  EXPECT_NEAR(use.observations[3].angle_rad / kDegree,
              14 + 3.2 - mean + k * (-0.5 - (3.2 - mean)), 1e-9);
  EXPECT_NEAR(use.observations[1].u_rad / kDegree,
              std::sqrt(k * 0.09 + (1 - k) * (1 - k) * variance), 1e-9);
}

// One trial in each of two set-ups: nothing tells their offsets.
TEST(UseSetAngles, KeepsSetUpsApart) {
  std::vector<Observation> trials{Set(10, 10.7, 0.3, true),
                                  Set(10, 9.7, 0.3, false)};
  trials[1].setup = 1;
  EXPECT_EQ(UseSetAngles(trials).used, 0);
}

// Whatever the ejector does, u' says how far x' is from the truth, and is less
// than u. 400 campaigns of 15 trials each, set angles of one to three trials.
TEST(UseSetAngles, StatesTheErrorThatIsLeft) {
  std::mt19937_64 engine(11);
  std::normal_distribution<double> normal;
  for (const double between : {0.0, 0.5, 2.0}) {
    double squares = 0.0;
    double shares = 0.0;
    int n = 0;
    for (int campaign = 0; campaign < 400; ++campaign) {
      std::vector<Observation> trials;
      std::vector<double> truth;
      const double offset = 2.0 * normal(engine);
      for (int s = 0; trials.size() < 15; ++s) {
        const double deviation = between * normal(engine);
        for (int i = 0; i <= s % 3; ++i) {
          truth.push_back(20.0 + s + offset + deviation + 0.5 * normal(engine));
          trials.push_back(
              Set(20.0 + s, truth.back() + 0.3 * normal(engine), 0.3, true));
        }
      }
      const SetAngleUse use = UseSetAngles(trials);
      for (std::size_t i = 0; i < trials.size(); ++i) {
        const Observation& o = use.observations[i];
        const double z = (o.angle_rad / kDegree - truth[i]) * kDegree / o.u_rad;
        squares += z * z;
        shares += o.u_rad / trials[i].u_rad;
        ++n;
      }
    }
    // The variances are estimated from as few trials.
    EXPECT_NEAR(squares / n, 1.0, 0.1) << between;
    EXPECT_LT(shares / n, between < 1.0 ? 0.93 : 0.97) << between;
  }
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
