#include "vision/src/layers/still_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "touchdown/core/normal.h"

namespace touchdown::vision::layers {
namespace {

constexpr std::int32_t kWidth = 240;
constexpr std::int32_t kHeight = 50;
constexpr double kBlur = 1.1;
constexpr double kContrast = 120.0;
constexpr double kLeast_dn = 4.0;

// Bright above the edge y(x), dark below, with noise.
std::vector<float> DrawEdge(const std::function<double(double)>& edge,
                            double noise_dn) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> noise(0.0, noise_dn);
  std::vector<float> levels;
  for (std::int32_t y = 0; y < kHeight; ++y) {
    for (std::int32_t x = 0; x < kWidth; ++x) {
      levels.push_back(static_cast<float>(
          50.0 + kContrast * core::NormalCdf((edge(x) - y) / kBlur) +
          noise(engine)));
    }
  }
  return levels;
}

double Straight(double x) { return 21.3 + 0.021 * x; }

TEST(StillEdges, AStraightEdgeIsOneLine) {
  const std::vector<float> levels = DrawEdge(Straight, 2.0);
  const auto lines =
      FindStillLines({levels.data(), {}, kWidth, kHeight}, kBlur, kLeast_dn);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_TRUE(lines[0].along_rows);
  EXPECT_FALSE(lines[0].rises);
  EXPECT_LT(lines[0].begin, 5);
  EXPECT_GT(lines[0].end, kWidth - 6);
  for (const double x : {0.0, 120.0, 239.0}) {
    EXPECT_NEAR(lines[0].At(x), Straight(x), x == 120.0 ? 0.015 : 0.04) << x;
  }
}

TEST(StillEdges, AnUprightEdgeIsOneToo) {
  const std::vector<float> level = DrawEdge(Straight, 2.0);
  std::vector<float> upright(level.size());
  for (std::int32_t y = 0; y < kHeight; ++y) {
    for (std::int32_t x = 0; x < kWidth; ++x) {
      upright[static_cast<std::size_t>(x * kHeight + y)] =
          level[static_cast<std::size_t>(y * kWidth + x)];
    }
  }
  const auto lines =
      FindStillLines({upright.data(), {}, kHeight, kWidth}, kBlur, kLeast_dn);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_FALSE(lines[0].along_rows);
  EXPECT_NEAR(lines[0].At(120.0), Straight(120.0), 0.02);
}

// What the body covers always is itself in the background.
TEST(StillEdges, WhatTheBodyHidesIsBridged) {
  std::vector<float> levels = DrawEdge(Straight, 2.0);
  std::vector<float> clear(levels.size(), 10.0F);
  for (std::int32_t y = 0; y < kHeight; ++y) {
    for (std::int32_t x = 90; x < 150; ++x) {
      const auto pixel = static_cast<std::size_t>(y * kWidth + x);
      clear[pixel] = 0.0F;
      levels[pixel] = y < Straight(x) - 2.0 ? 230.0F : 60.0F;
    }
  }
  const auto lines =
      FindStillLines({levels.data(), clear, kWidth, kHeight}, kBlur, kLeast_dn);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NEAR(lines[0].At(120.0), Straight(120.0), 0.02);
  const auto edges = FindStillEdges({levels.data(), clear, kWidth, kHeight},
                                    lines, kBlur, kLeast_dn);
  const std::int32_t y = 24;
  const StillEdge& hidden = edges[static_cast<std::size_t>(y * kWidth + 120)];
  EXPECT_NEAR(hidden.contrast, kContrast, 0.05 * kContrast);
  EXPECT_NEAR(hidden.z, (Straight(120.0) - y) / kBlur, 0.03);
  EXPECT_NEAR(hidden.normal_y, -1.0, 1e-3);
}

// Pixels two blurs from an edge hardly tell where it is.
TEST(StillEdges, ALineTellsPlaceBetterThanThreePixels) {
  const std::vector<float> levels = DrawEdge(Straight, 2.0);
  const StillPicture still{levels.data(), {}, kWidth, kHeight};
  const auto lines = FindStillLines(still, kBlur, kLeast_dn);
  const auto rms = [&](const std::vector<StillEdge>& edges) {
    double square = 0.0;
    double count = 0.0;
    for (std::int32_t x = 10; x < kWidth - 10; ++x) {
      const auto y = static_cast<std::int32_t>(std::lround(Straight(x))) - 2;
      const StillEdge& edge = edges[static_cast<std::size_t>(y * kWidth + x)];
      if (edge.contrast == 0.0F) continue;
      square +=
          std::pow(static_cast<double>(edge.z) - (Straight(x) - y) / kBlur, 2);
      count += 1.0;
    }
    return std::sqrt(square / count);
  };
  EXPECT_LT(rms(FindStillEdges(still, lines, kBlur, kLeast_dn)), 0.02);
  EXPECT_GT(rms(FindStillEdges(still, {}, kBlur, kLeast_dn)), 0.1);
}

// As a renderer or a scaled video draws it: each pixel has its share of both
// sides, and is blurred after that. Three pixels' curvature then changes with
// the edge's place between two pixels.
std::vector<float> DrawSampledEdge(const std::function<double(double)>& edge) {
  const double s = std::sqrt(kBlur * kBlur - 1.0 / 12.0);
  constexpr std::int32_t kReach = 6;
  std::vector<float> levels;
  for (std::int32_t y = 0; y < kHeight; ++y) {
    for (std::int32_t x = 0; x < kWidth; ++x) {
      double sum = 0.0;
      double share = 0.0;
      for (std::int32_t i = -kReach; i <= kReach; ++i) {
        const double weight = std::exp(-0.5 * i * i / (s * s));
        sum += weight;
        share += weight * std::clamp(0.5 + edge(x) - (y + i), 0.0, 1.0);
      }
      levels.push_back(static_cast<float>(50.0 + kContrast * share / sum));
    }
  }
  return levels;
}

TEST(StillEdges, ContrastIsThatOfAllPlacesBetweenTwoPixels) {
  const std::vector<float> levels = DrawSampledEdge(Straight);
  const StillPicture still{levels.data(), {}, kWidth, kHeight};
  const auto lines = FindStillLines(still, kBlur, kLeast_dn);
  ASSERT_EQ(lines.size(), 1U);
  const auto edges = FindStillEdges(still, lines, kBlur, kLeast_dn);
  for (std::int32_t x = 10; x < kWidth - 10; ++x) {
    const auto y = static_cast<std::int32_t>(std::lround(Straight(x)));
    EXPECT_NEAR(edges[static_cast<std::size_t>(y * kWidth + x)].contrast,
                kContrast, 0.02 * kContrast)
        << x;
  }
}

TEST(StillEdges, ALevelEdgeBetweenTwoPixelsIsInItsPlace) {
  for (const double between : {0.1, 0.25, 0.4, 0.6, 0.75, 0.9}) {
    const double y = 21.0 + between;
    const std::vector<float> levels =
        DrawSampledEdge([y](double) { return y; });
    const auto lines =
        FindStillLines({levels.data(), {}, kWidth, kHeight}, kBlur, kLeast_dn);
    ASSERT_EQ(lines.size(), 1U) << between;
    EXPECT_NEAR(lines[0].At(120.0), y, 0.02) << between;
  }
}

// As a lens bends it, by 2 px over the picture.
TEST(StillEdges, ABentEdgeIsSeveralLines) {
  const auto bent = [](double x) {
    return 22.0 + 2.0 * std::pow((x - 120.0) / 120.0, 2);
  };
  const std::vector<float> levels = DrawEdge(bent, 1.0);
  const auto lines =
      FindStillLines({levels.data(), {}, kWidth, kHeight}, kBlur, kLeast_dn);
  ASSERT_GE(lines.size(), 2U);
  for (const StillLine& line : lines) {
    for (std::int32_t x = line.begin; x <= line.end; ++x) {
      EXPECT_NEAR(line.At(x), bent(x), 0.2) << x;
    }
  }
}

// Crossings of noise are on no line.
TEST(StillEdges, NoiseIsNoLine) {
  const std::vector<float> levels =
      DrawEdge([](double) { return -50.0; }, 20.0);
  EXPECT_TRUE(
      FindStillLines({levels.data(), {}, kWidth, kHeight}, kBlur, kLeast_dn)
          .empty());
}

TEST(StillEdges, ALineWithinAPartHasThePartsCoordinates) {
  StillLine line;
  line.begin = 3;
  line.end = 90;
  line.at_zero = 20.0;
  line.slope = 0.1;
  const StillLine within = line.Within(10, 7);
  EXPECT_EQ(within.begin, -7);
  EXPECT_EQ(within.end, 80);
  EXPECT_NEAR(within.At(5.0), line.At(15.0) - 7.0, 1e-12);
  line.along_rows = false;
  EXPECT_NEAR(line.Within(10, 7).At(5.0), line.At(12.0) - 10.0, 1e-12);
}

}  // namespace
}  // namespace touchdown::vision::layers
