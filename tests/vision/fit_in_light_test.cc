#include "vision/src/tracking/fit_in_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <optional>
#include <vector>

namespace touchdown::vision {
namespace {

using layers::LayerFit;

const BodySize kSize{{40.0, 0.02, std::nullopt}, {20.0, 0.02, std::nullopt}};

// A textured face, whose sides are held.
LayerFit Held(double beside_px) {
  LayerFit fit;
  fit.layers.shape = {false, 20.0, 10.0};
  fit.beyond_px = beside_px;
  return fit;
}

TEST(OutlinesBeside, OfTheSideThatIsFartherOffBeyondItsU) {
  LayerFit fit = Held(0.0);
  EXPECT_EQ(OutlinesBeside(fit, kSize), 0.0);
  fit.layers.shape.half_short = 10.1;
  fit.layers.shape.half_long = 20.02;
  EXPECT_NEAR(OutlinesBeside(fit, kSize), 0.1, 0.001);
  fit.beyond_px = 0.1;
  EXPECT_NEAR(OutlinesBeside(fit, kSize), 0.1414, 0.001);
  // A disc has one side.
  fit = Held(0.0);
  fit.layers.shape = {true, 20.0, 15.0};
  EXPECT_EQ(OutlinesBeside(fit, kSize), 0.0);
}

// Of cost((log gamma - lowest) / u) at such log gammas.
std::vector<GammaTrial> Trials(double lowest, double u,
                               std::initializer_list<double> log_gammas) {
  std::vector<GammaTrial> trials;
  for (const double at : log_gammas) {
    const double z = (at - lowest) / u;
    trials.push_back({at, 7.0 + 0.5 * z * z, {}});
  }
  return trials;
}

TEST(FindLeastLogGamma, OfAParabola) {
  EXPECT_NEAR(FindLeastLogGamma(Trials(-0.6, 0.2, {0.0, -0.35, -0.8})), -0.6,
              1e-12);
}

TEST(FindLeastLogGamma, NoneBeyondWhatCamerasHave) {
  EXPECT_EQ(FindLeastLogGamma(Trials(0.2, 0.2, {0.0, -0.35, -0.8})), 0.0);
  EXPECT_NEAR(FindLeastLogGamma(Trials(-3.0, 0.2, {0.0, -0.35, -0.8})),
              std::log(0.3), 1e-12);
}

// A cost that falls ever more steeply.
TEST(FindLeastLogGamma, TheLastWhereNoParabolaHasALeast) {
  EXPECT_EQ(
      FindLeastLogGamma({{0.0, 9.0, {}}, {-0.35, 8.5, {}}, {-0.8, 1.0, {}}}),
      -0.8);
}

TEST(LogGammaUncertainty, OfAParabolaWhateverTheOrder) {
  EXPECT_NEAR(LogGammaUncertainty(Trials(-0.6, 0.15, {0.0, -0.35, -0.8, -0.6})),
              0.15, 1e-12);
}

// The mean square of x by a sum over the slab.
TEST(LogGammaUncertainty, OfALinearCameraIsThatOfTheSlab) {
  const double slab = -std::log(0.3);
  for (const double steep : {8.0, 20.0}) {
    double square = 0.0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double x = slab * (i + 0.5) / kSteps;
      square += x * x * std::exp(-steep * x) / kSteps;
    }
    EXPECT_NEAR(
        LogGammaUncertainty({{0.0, 3.0, {}}, {-0.35, 3.0 + 0.35 * steep, {}}}),
        std::sqrt(square), 0.02 * std::sqrt(square))
        << steep;
  }
}

TEST(LogGammaUncertainty, IsNeverMoreThanThatOfAnyGamma) {
  const double most = -std::log(0.3) / std::sqrt(3.0);
  EXPECT_EQ(LogGammaUncertainty({{0.0, 3.0, {}}}), most);
  EXPECT_EQ(LogGammaUncertainty({{0.0, 3.0, {}}, {-0.35, 3.0, {}}}), most);
  EXPECT_EQ(LogGammaUncertainty({{0.0, 3.0, {}}, {-0.35, 2.0, {}}}), most);
}

}  // namespace
}  // namespace touchdown::vision
