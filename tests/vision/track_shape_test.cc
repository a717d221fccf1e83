#include "vision/src/outline/track_shape.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "vision/src/numbers/robust.h"

namespace touchdown::vision {
namespace {

using ::testing::Each;

constexpr double kRadius_px = 8.0;
constexpr double kU_px = 0.05;

// Fits of a sphere that lacks `lack_px[i]` of its radius in frame i.
std::vector<Fitted> FitsOf(const std::vector<double>& lack_px,
                           std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> noise(0.0, kU_px);
  std::vector<Fitted> all;
  for (const double lack : lack_px) {
    Fitted fitted;
    fitted.frame = static_cast<std::int64_t>(all.size());
    fitted.fit.outline.radius_px = kRadius_px - lack + noise(engine);
    fitted.fit.u_size_px = kU_px;
    all.push_back(fitted);
  }
  return all;
}

double MedianInOrder(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half]
                                : 0.5 * (values[half - 1] + values[half]);
}

// Of many numbers only those are put in order that a sample says are near.
TEST(Median, OfManyNumbers) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> noise(0.0, 3.0);
    std::vector<double> values(3000 + seed);
    for (double& v : values) v = noise(engine);
    EXPECT_EQ(Median(values), MedianInOrder(values)) << seed;
    // With many equal ones.
    for (double& v : values) v = std::round(v);
    EXPECT_EQ(Median(values), MedianInOrder(values)) << seed;
    // The sample, every 24th or so, tells nothing of the others.
    for (std::size_t k = 0; k < 128; ++k) {
      values[k * values.size() / 128] = 1e6;
    }
    EXPECT_EQ(Median(values), MedianInOrder(values)) << seed;
  }
}

TEST(FindHidden, NoiseHidesNothing) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    EXPECT_THAT(FindHidden(FitsOf(std::vector<double>(60, 0.0), seed)),
                Each(false))
        << seed;
  }
}

TEST(FindHidden, ComesOutFromBehindSomething) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    std::vector<double> lack(30, 0.0);
    // By ten to fifty standard uncertainties, and in one more by four: that
    // alone would not tell, beside the others it does.
    for (std::size_t i = 0; i < 5; ++i) {
      lack[i] = (50.0 - 10.0 * static_cast<double>(i)) * kU_px;
    }
    lack[5] = 7.0 * kU_px;
    const std::vector<bool> hidden = FindHidden(FitsOf(lack, seed));
    for (std::size_t i = 0; i < 6; ++i) EXPECT_TRUE(hidden[i]) << i;
    // Next to them a frame may be lost by noise, farther away none.
    for (std::size_t i = 9; i < lack.size(); ++i) EXPECT_FALSE(hidden[i]) << i;
  }
}

TEST(FindHidden, HalfOfTheFramesMustShowItWhole) {
  std::vector<double> lack(30, 0.0);
  for (std::size_t i = 0; i < 18; ++i) lack[i] = 1.0;
  EXPECT_THAT(FindHidden(FitsOf(lack, 1)), Each(false));
}

TEST(FindHidden, TooFewFramesToTell) {
  EXPECT_THAT(FindHidden(FitsOf({1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0}, 1)),
              Each(false));
  EXPECT_TRUE(FindHidden({}).empty());
}

// A block whose one end is hidden keeps its shorter side.
TEST(FindHidden, EitherSideOfABlock) {
  std::vector<Fitted> all;
  for (int i = 0; i < 20; ++i) {
    Fitted fitted;
    fitted.fit.outline.kind = core::BodyKind::kRectangle;
    fitted.fit.outline.half_long_px = i < 4 ? 18.0 : 20.0;
    fitted.fit.outline.half_short_px = i >= 16 ? 7.0 : 8.0;
    fitted.fit.u_size_px = fitted.fit.u_size_short_px = kU_px;
    all.push_back(fitted);
  }
  const std::vector<bool> hidden = FindHidden(all);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(hidden[i], i < 4 || i >= 16) << i;
  }
}

// Fits along a straight line of `length_px`, as they scatter.
std::vector<Fitted> AlongALine(double length_px, std::uint64_t seed) {
  std::vector<Fitted> all = FitsOf(std::vector<double>(30, 0.0), seed);
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> noise(0.0, kU_px);
  for (Fitted& f : all) {
    const double share = static_cast<double>(f.frame) / 29.0;
    f.fit.outline.centre = {50.0 + 0.8 * length_px * share + noise(engine),
                            20.0 - 0.6 * length_px * share + noise(engine)};
  }
  return all;
}

TEST(Moves, APartOfTheSceneDoesNot) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    std::vector<Fitted> still = AlongALine(0.0, seed);
    EXPECT_FALSE(Moves(still)) << seed;
    still[7].fit.outline.centre.x_px += 40.0;  // slipped
    EXPECT_FALSE(Moves(still)) << seed;
    EXPECT_TRUE(Moves(AlongALine(2.0, seed))) << seed;
  }
  EXPECT_FALSE(Moves({}));
}

TEST(IsMeasured, TakesNoneWithoutUncertainty) {
  OutlineFit fit;
  fit.outline.kind = core::BodyKind::kRectangle;
  fit.u_x_px = 0.01;
  fit.u_y_px = 0.01;
  EXPECT_FALSE(IsMeasured(fit));
  fit.u_angle_rad = 0.001;
  EXPECT_TRUE(IsMeasured(fit));
  fit.u_x_px = 0.0;
  EXPECT_FALSE(IsMeasured(fit));
  // A disc's angle is never told.
  fit.outline.kind = core::BodyKind::kSphere;
  fit.u_x_px = 0.01;
  fit.u_angle_rad = 0.0;
  EXPECT_TRUE(IsMeasured(fit));
}

}  // namespace
}  // namespace touchdown::vision
