#include "vision/src/tracking/fit_in_light.h"

#include <gtest/gtest.h>

#include <optional>

namespace touchdown::vision {
namespace {

using layers::LayerFit;

const BodySize kSize{{40.0, 0.02, std::nullopt}, {20.0, 0.02, std::nullopt}};

// A textured face, whose sides are held.
LayerFit Held(double loss, double beside_px) {
  LayerFit fit;
  fit.layers.shape = {false, 20.0, 10.0};
  fit.loss = loss;
  fit.beyond_px = beside_px;
  return fit;
}

TEST(OutlinesBeside, OfTheSideThatIsFartherOffBeyondItsU) {
  LayerFit fit = Held(1.0, 0.0);
  EXPECT_EQ(OutlinesBeside(fit, kSize), 0.0);
  fit.layers.shape.half_short = 10.1;
  fit.layers.shape.half_long = 20.02;
  EXPECT_NEAR(OutlinesBeside(fit, kSize), 0.1, 0.001);
  fit.beyond_px = 0.1;
  EXPECT_NEAR(OutlinesBeside(fit, kSize), 0.1414, 0.001);
  // A disc has one side.
  fit = Held(1.0, 0.0);
  fit.layers.shape = {true, 20.0, 15.0};
  EXPECT_EQ(OutlinesBeside(fit, kSize), 0.0);
}

// Losses and distances of clips of known truth, rendered by generators of
// another hand (strangers, composite.py, seeds 29 and 30).

TEST(IsBetterInLight, BothWitnessesSpeakForIt) {
  EXPECT_TRUE(IsBetterInLight(Held(0.1043, 0.0), Held(0.1148, 0.3111), kSize));
  EXPECT_TRUE(
      IsBetterInLight(Held(0.4949, 0.0911), Held(0.5004, 0.1460), kSize));
}

// A fit that has not settled.
TEST(IsBetterInLight, SidesDecideWhereBothExplainTheLevels) {
  EXPECT_TRUE(
      IsBetterInLight(Held(0.4321, 0.0773), Held(0.4302, 0.2182), kSize));
  EXPECT_FALSE(
      IsBetterInLight(Held(0.4337, 0.0752), Held(0.4317, 0.1317), kSize));
}

// Linear cameras, whose outlines seemed to show 0.36 and 0.56.
TEST(IsBetterInLight, SidesOrLevelsMaySpeakAgainstIt) {
  EXPECT_FALSE(IsBetterInLight(Held(0.0575, 0.0734), Held(0.0577, 0.0), kSize));
  EXPECT_FALSE(
      IsBetterInLight(Held(0.1836, 0.0422), Held(0.1819, 0.0724), kSize));
}

TEST(IsBetterInLight, WithoutASizeLevelsDecide) {
  EXPECT_TRUE(IsBetterInLight(Held(0.9, 0.5), Held(1.0, 0.0), std::nullopt));
  EXPECT_FALSE(IsBetterInLight(Held(1.0, 0.0), Held(0.9, 0.5), std::nullopt));
}

}  // namespace
}  // namespace touchdown::vision
