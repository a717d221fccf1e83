#include "touchdown/rig/uncertainty.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "touchdown/rig/launch.h"

namespace touchdown::rig {
namespace {

Spring Baseline() {
  Spring spring;
  spring.shear_modulus_pa = 79.3e9;
  spring.wire_diameter_m = 2e-3;
  spring.coil_diameter_m = 18e-3;
  spring.coil_diameter = CoilDiameter::kOuter;
  spring.active_coils = 10.0;
  spring.total_coils = 12.0;
  return spring;
}

const IdealRelativeU kReferenceU{0.01, 0.005, 0.01, 0.005, 0.01, 0.002};
const IdealRelativeU kFivePercent{0.02, 0.05, 0.02, 0.05, 0.05, 0.01};

core::Expected<std::vector<double>> One(double y) {
  return std::vector<double>{y};
}

TEST(FirstOrder, LinearModelIsExact) {
  const std::array<UncertainInput, 2> inputs{
      UncertainInput{"a", {2.0, 0.3, {}}}, UncertainInput{"b", {5.0, 0.4, {}}}};
  const auto out = PropagateFirstOrder(inputs, [](std::span<const double> x) {
    return One(1.0 * x[0] - 1.0 * x[1]);
  });
  ASSERT_TRUE(out);
  EXPECT_EQ((*out)[0].estimate.value, -3.0);
  EXPECT_NEAR((*out)[0].estimate.u, 0.5, 1e-12);  // 3-4-5
  ASSERT_EQ((*out)[0].budget.size(), 2u);
  EXPECT_EQ((*out)[0].budget[1].source, "b");
  EXPECT_NEAR((*out)[0].budget[1].u, 0.4, 1e-12);
}

TEST(FirstOrder, AgreesWithTheClosedFormOfEquation10) {
  // The numerical derivative against theory.md section 6's exponents.
  for (const CoilDiameter kind :
       {CoilDiameter::kMean, CoilDiameter::kOuter, CoilDiameter::kInner}) {
    Spring spring = Baseline();
    spring.coil_diameter = kind;
    const std::array<UncertainInput, 4> inputs{
        UncertainInput{"G", {79.3e9, 79.3e9 * 0.01, {}}},
        UncertainInput{"d", {2e-3, 2e-3 * 0.005, {}}},
        UncertainInput{"n", {10.0, 10.0 * 0.01, {}}},
        UncertainInput{"D", {18e-3, 18e-3 * 0.005, {}}}};
    const auto out = PropagateFirstOrder(inputs, [&](auto x) {
      Spring s = spring;
      s.shear_modulus_pa = x[0];
      s.wire_diameter_m = x[1];
      s.active_coils = x[2];
      s.coil_diameter_m = x[3];
      return One(IdealLaunchSpeed(0.05, Stiffness(s), 0.1));
    });
    const IdealRelativeU u{0.01, 0.005, 0.01, 0.005, 0.0, 0.0};
    const core::Estimate e = (*out)[0].estimate;
    EXPECT_NEAR(e.u / e.value, IdealSpeedUncertainty(spring, u).u_rel, 1e-8)
        << Name(kind);
  }
}

TEST(FirstOrder, ClosedFormOfReference) {  // SP01
  const IdealSpeedU u = IdealSpeedUncertainty(Baseline(), kReferenceU);
  EXPECT_NEAR(u.u_rel, 0.018488383177011450, 1e-17);
  EXPECT_NEAR(u.bias_rel, 0.00012093359375, 1e-18);
  EXPECT_NEAR(PrintedSpeedUncertainty(kReferenceU).u_rel, 0.017528548142958104,
              1e-17);
}

TEST(FirstOrder, ClosedFormAtFivePercent) {  // theory.md section 6
  const IdealSpeedU u = IdealSpeedUncertainty(Baseline(), kFivePercent);
  EXPECT_NEAR(u.u_rel, 0.1477, 5e-5);
  EXPECT_NEAR(u.bias_rel, 0.00958, 5e-6);
}

TEST(FirstOrder, AtTheEdgeOfTheModelIsOneSided) {
  const std::array<UncertainInput, 1> inputs{
      UncertainInput{"x", {0.0, 0.1, {}}}};
  const auto out = PropagateFirstOrder(
      inputs, [](auto x) -> core::Expected<std::vector<double>> {
        if (x[0] < 0.0) return core::AbsentBecause("negative");
        return One(3.0 * x[0]);
      });
  EXPECT_NEAR((*out)[0].estimate.u, 0.3, 1e-12);
}

TEST(FirstOrder, AbsentModelIsAbsent) {
  const std::array<UncertainInput, 1> inputs{
      UncertainInput{"x", {1.0, 0.1, {}}}};
  const auto out = PropagateFirstOrder(
      inputs, [](auto) -> core::Expected<std::vector<double>> {
        return core::AbsentBecause("does not leave the muzzle");
      });
  ASSERT_FALSE(out);
  EXPECT_EQ(out.error().reason, "does not leave the muzzle");
}

TEST(MonteCarlo, OfReferenceWithinItsNoise) {  // SP01: 2e6 draws of numpy
  constexpr std::size_t kDraws = 200'000;
  std::mt19937_64 engine(12345);
  const MonteCarloRun run =
      IdealSpeedMonteCarlo(Baseline(), kReferenceU, kDraws, engine);
  ASSERT_EQ(run.outputs.size(), 1u);
  EXPECT_EQ(run.impossible, 0u);
  const MonteCarlo& mc = run.outputs[0];
  const double se_mean = 0.0185 / std::sqrt(double{kDraws});
  const double se_u = 0.0185 / std::sqrt(2.0 * double{kDraws});
  EXPECT_NEAR(mc.mean, 1.0001084406449654, 5.0 * se_mean);
  EXPECT_NEAR(mc.u, 0.018511809268382490, 5.0 * se_u);
  // A quantile's standard error: sqrt(p(1-p)/M)/density; 2.67 u/sqrt(M) here.
  EXPECT_NEAR(mc.interval95.low, 0.9642487309375436, 5.0 * 2.67 * se_mean);
  EXPECT_NEAR(mc.interval95.high, 1.0368396870209906, 5.0 * 2.67 * se_mean);
  EXPECT_NEAR(mc.u_of_u, mc.u / std::sqrt(2.0 * double{kDraws}), 1e-18);
}

TEST(MonteCarlo, SeesTheBiasThatTheFirstOrderMisses) {  // theory.md section 6
  std::mt19937_64 engine(12345);
  const MonteCarlo mc =
      IdealSpeedMonteCarlo(Baseline(), kFivePercent, 200'000, engine)
          .outputs[0];
  EXPECT_NEAR(mc.mean, 1.0096, 5.0 * 0.15 / std::sqrt(200'000.0));
  EXPECT_NEAR(mc.u, 0.1504, 5.0 * 0.15 / std::sqrt(400'000.0) + 5e-5);
}

TEST(MonteCarlo, SameSeedSameNumbers) {
  std::mt19937_64 one(9);
  std::mt19937_64 other(9);
  const auto a = IdealSpeedMonteCarlo(Baseline(), kReferenceU, 1000, one);
  const auto b = IdealSpeedMonteCarlo(Baseline(), kReferenceU, 1000, other);
  EXPECT_EQ(a.outputs[0].mean, b.outputs[0].mean);
  EXPECT_EQ(a.outputs[0].interval95, b.outputs[0].interval95);
  // The engine goes on: the next run is another.
  const auto c = IdealSpeedMonteCarlo(Baseline(), kReferenceU, 1000, one);
  EXPECT_NE(a.outputs[0].mean, c.outputs[0].mean);
}

TEST(MonteCarlo, SurvivesAnOffset) {
  const std::array<UncertainInput, 1> inputs{
      UncertainInput{"x", {1e9, 1e-3, {}}}};
  std::mt19937_64 engine(4);
  const auto run = PropagateMonteCarlo(
      inputs, [](auto x) { return One(x[0]); }, 20'000, engine);
  EXPECT_NEAR(run.outputs[0].u, 1e-3, 5e-5);
}

TEST(MonteCarlo, CountsWhatIsImpossible) {
  // Half of the draws below 0, and of the others those above one u: 0.5 +
  // 0.159.
  const std::array<UncertainInput, 1> inputs{
      UncertainInput{"x", {0.0, 1.0, {}}, 0.0}};
  std::mt19937_64 engine(2);
  const auto run = PropagateMonteCarlo(
      inputs,
      [](auto x) -> core::Expected<std::vector<double>> {
        if (x[0] > 1.0) return core::AbsentBecause("too large");
        return One(x[0]);
      },
      40'000, engine);
  EXPECT_NEAR(static_cast<double>(run.impossible) / 40'000.0, 0.6587, 0.012);
  EXPECT_GT(run.outputs[0].interval95.low, 0.0);
  EXPECT_LT(run.outputs[0].interval95.high, 1.0);
}

TEST(MonteCarlo, QuantilesOfJcgm101) {
  // 7.7: of 1000 draws, the 25th and the 975th; here of a shuffled ramp.
  const std::array<UncertainInput, 1> inputs{
      UncertainInput{"x", {0.0, 1.0, {}}}};
  std::mt19937_64 engine(2);
  int next = 0;
  const auto run = PropagateMonteCarlo(
      inputs, [&](auto) { return One((next++ * 7 % 1000) + 1.0); }, 1000,
      engine);
  EXPECT_EQ(run.outputs[0].interval95.low, 25.0);
  EXPECT_EQ(run.outputs[0].interval95.high, 975.0);
  EXPECT_NEAR(run.outputs[0].mean, 500.5, 1e-12);
}

TEST(MonteCarlo, TellsWhereTheFirstOrderFails) {
  // y = |x| at x = 0: derivative 0 by symmetry, yet y spreads.
  const std::array<UncertainInput, 1> inputs{
      UncertainInput{"x", {0.0, 1.0, {}}}};
  const Model model = [](auto x) { return One(std::abs(x[0])); };
  std::mt19937_64 engine(1);
  const auto gum = PropagateFirstOrder(inputs, model);
  const auto run = PropagateMonteCarlo(inputs, model, 20'000, engine);
  EXPECT_EQ((*gum)[0].estimate.u, 0.0);
  // Half-normal: mean sqrt(2/pi), standard deviation sqrt(1 - 2/pi).
  EXPECT_NEAR(run.outputs[0].mean, std::sqrt(2.0 / std::numbers::pi), 0.02);
  EXPECT_NEAR(run.outputs[0].u, std::sqrt(1.0 - 2.0 / std::numbers::pi), 0.02);
  EXPECT_FALSE(FirstOrderIsValid((*gum)[0].estimate, run.outputs[0]));
}

TEST(MonteCarlo, ToleranceOfJcgm101Clause8) {
  // u = 0.023 is 2e-2 to one digit: tolerance 0.005; to two 0.0005.
  const core::Estimate gum{1.0, 0.023, {}};
  const core::Interval exact = core::Interval95(gum);
  MonteCarlo mc{1.0, 0.023, 1e-4, {exact.low + 0.0049, exact.high - 0.0049}};
  EXPECT_TRUE(FirstOrderIsValid(gum, mc));
  EXPECT_FALSE(FirstOrderIsValid(gum, mc, 2));
  mc.interval95.low = exact.low + 0.0051;
  EXPECT_FALSE(FirstOrderIsValid(gum, mc));
  // 0.096 rounds to 1e-1: tolerance 0.05.
  const core::Estimate wide{1.0, 0.096, {}};
  const core::Interval w = core::Interval95(wide);
  EXPECT_TRUE(
      FirstOrderIsValid(wide, {1.0, 0.096, 1e-4, {w.low + 0.04, w.high}}));
}

TEST(Uncertainty, ImpossibleInputIsRefused) {
  const std::array<UncertainInput, 1> bad{UncertainInput{"x", {1.0, -0.1, {}}}};
  const Model model = [](auto x) { return One(x[0]); };
  std::mt19937_64 engine(1);
  try {
    (void)PropagateFirstOrder(bad, model);
    ADD_FAILURE();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "x.u is -0.1, must be at least 0 and finite");
  }
  const std::array<UncertainInput, 1> good{UncertainInput{"x", {1.0, 0.1, {}}}};
  EXPECT_THROW((void)PropagateMonteCarlo(good, model, 1, engine),
               std::invalid_argument);
  IdealRelativeU u;
  u.mass = -0.1;
  EXPECT_THROW((void)IdealSpeedUncertainty(Baseline(), u),
               std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::rig
