#include "vision/src/outline/spots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace touchdown::vision {
namespace {

constexpr double kSize_px = 8.0;
constexpr double kNoise_dn = 2.0;

struct Face {
  double level_dn = 0.0;  // of its spot
  double x_px = -2.0;
  double y_px = -3.0;
  double sigma_px = 1.6;
  double curvature_dn = 0.0;  // of its shading, at the size
};

double LevelAt(const Face& face, double x, double y) {
  const double dx = (x - face.x_px) / face.sigma_px;
  const double dy = (y - face.y_px) / face.sigma_px;
  return 5.0 + 0.3 * x - 0.2 * y +
         face.curvature_dn * (x * x + y * y) / (kSize_px * kSize_px) +
         face.level_dn * std::exp(-0.5 * (dx * dx + dy * dy));
}

// A disc seen at places half a pixel apart; `frames` samples at each.
struct Seen {
  std::vector<SpotSample> cells;
  std::vector<SpotSample> samples;
};

Seen SeenOf(const Face& face, int frames, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> noise(0.0, kNoise_dn);
  std::uniform_real_distribution<double> within(-0.25, 0.25);
  Seen seen;
  for (int row = -12; row <= 12; ++row) {
    for (int column = -12; column <= 12; ++column) {
      const double x = 0.5 * column;
      const double y = 0.5 * row;
      if (x * x + y * y > 36.0) continue;
      SpotSample mean = {0.0, 0.0, 0.0, kNoise_dn * kNoise_dn / frames};
      for (int i = 0; i < frames; ++i) {
        SpotSample s = {x + within(engine), y + within(engine), 0.0,
                        kNoise_dn * kNoise_dn};
        s.level_dn = LevelAt(face, s.x_px, s.y_px) + noise(engine);
        mean.x_px += s.x_px / frames;
        mean.y_px += s.y_px / frames;
        mean.level_dn += s.level_dn / frames;
        seen.samples.push_back(s);
      }
      seen.cells.push_back(mean);
    }
  }
  return seen;
}

SpotOptions Options() {
  SpotOptions options;
  options.size_px = kSize_px;
  options.reach_px = kSize_px;
  return options;
}

TEST(FindSpots, ASmoothFaceHasNone) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Seen seen = SeenOf({.curvature_dn = 20.0}, 8, seed);
    EXPECT_FALSE(FindSpots(seen.cells, seen.samples, Options())) << seed;
  }
}

TEST(FindSpots, KnowsASpotAsWellAsItSays) {
  double square = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Face face = {.level_dn = seed % 2 == 0 ? 15.0 : -15.0,
                       .curvature_dn = 10.0};
    const Seen seen = SeenOf(face, 8, seed);
    const auto found = FindSpots(seen.cells, seen.samples, Options());
    ASSERT_TRUE(found) << seed;
    EXPECT_EQ(found->spots, 1) << seed;
    const double s = 1.0 / (face.sigma_px * face.sigma_px);
    const double truth[] = {face.level_dn, face.x_px, face.y_px, s, 0.0, s};
    for (int i = 0; i < SpotModel::kSpot; ++i) {
      const int at = SpotModel::kShading + i;
      const double u = std::sqrt(found->covariance(at, at));
      const double z = (found->parameters[at] - truth[i]) / u;
      EXPECT_LT(std::abs(z), 5.0) << seed << ": parameter " << i;
      square += z * z;
      ++count;
    }
  }
  // 60 x 6 values: a mean square of 1 +- 0.08, and what Huber costs.
  EXPECT_NEAR(square / count, 1.0, 0.35);
}

TEST(FindSpots, DerivativesAreThose) {
  const Seen seen = SeenOf({.level_dn = 40.0}, 8, 1);
  const auto found = FindSpots(seen.cells, seen.samples, Options());
  ASSERT_TRUE(found);
  NormalVector by(found->parameters.size());
  NormalVector unused(found->parameters.size());
  found->At(-1.3, -2.2, &by);
  for (int i = 0; i < by.size(); ++i) {
    constexpr double kStep = 1e-5;
    SpotModel more = *found;
    more.parameters[i] += kStep;
    SpotModel less = *found;
    less.parameters[i] -= kStep;
    const double slope =
        (more.At(-1.3, -2.2, nullptr) - less.At(-1.3, -2.2, nullptr)) /
        (2.0 * kStep);
    EXPECT_NEAR(by[i], slope, 1e-5 * (1.0 + std::abs(slope))) << i;
  }
}

TEST(FindSpots, TwoSpots) {
  Seen seen = SeenOf({.level_dn = 40.0}, 8, 3);
  const Face other = {.level_dn = -25.0, .x_px = 3.0, .y_px = 2.0};
  const double shading = LevelAt({}, 0.0, 0.0);
  for (auto* const samples : {&seen.cells, &seen.samples}) {
    for (SpotSample& s : *samples) {
      s.level_dn += LevelAt(other, s.x_px, s.y_px) - 0.3 * s.x_px +
                    0.2 * s.y_px - shading;
    }
  }
  const auto found = FindSpots(seen.cells, seen.samples, Options());
  ASSERT_TRUE(found);
  EXPECT_EQ(found->spots, 2);
}

}  // namespace
}  // namespace touchdown::vision
