#include "vision/src/tracking/unknown_gamma.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace touchdown::vision {
namespace {

// Where the straight edge that fits the levels of an edge in light best lies,
// px toward the first side: least squares over its place alone, by bisection.
double FittedShift(double first, double second, double blur, double gamma) {
  const auto cover = [&](double at) {
    return 0.5 * std::erfc(at / (blur * std::numbers::sqrt2));
  };
  const auto slope = [&](double shift) {
    double sum = 0.0;
    constexpr double kStep_px = 0.01;
    for (double at = -8.0 * blur; at < 8.0 * blur; at += kStep_px) {
      const double light =
          std::pow(first, 1.0 / gamma) +
          (std::pow(second, 1.0 / gamma) - std::pow(first, 1.0 / gamma)) *
              cover(at);
      const double off =
          std::pow(light, gamma) - first - (second - first) * cover(at - shift);
      const double z = (at - shift) / blur;
      sum += off * (second - first) * std::exp(-0.5 * z * z);
    }
    return sum;
  };
  double low = -2.0 * blur;
  double high = 2.0 * blur;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (slope(middle) > 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

TEST(EdgeShift, IsThatOfALeastSquaresFit) {
  for (const double second : {15.0, 60.0, 110.0, 220.0}) {
    for (const double gamma : {0.8, 0.45}) {
      const double fitted = FittedShift(130.0, second, 0.9, gamma);
      EXPECT_NEAR(EdgeShift(130.0, second, 0.9, gamma), fitted,
                  0.15 * std::abs(fitted))
          << second << ' ' << gamma;
    }
  }
}

TEST(EdgeShift, GoesToTheDarkSideAndNotWithoutGammaOrContrast) {
  EXPECT_GT(EdgeShift(50.0, 200.0, 1.0, 0.45), 0.1);
  EXPECT_NEAR(EdgeShift(200.0, 50.0, 1.0, 0.45),
              -EdgeShift(50.0, 200.0, 1.0, 0.45), 1e-12);
  EXPECT_NEAR(EdgeShift(50.0, 200.0, 1.0, 1.0), 0.0, 1e-12);
  EXPECT_EQ(EdgeShift(90.0, 90.0, 1.0, 0.45), 0.0);
  // Exposure and bit depth do not matter.
  EXPECT_NEAR(EdgeShift(800.0, 3200.0, 1.0, 0.45),
              EdgeShift(50.0, 200.0, 1.0, 0.45), 1e-12);
}

Track Seen(core::BodyKind kind, double contrast_dn) {
  Track track;
  track.body.kind = kind;
  track.body.radius_px = {9.0, 0.01, std::nullopt};
  track.body.half_long_px = {12.0, 0.01, std::nullopt};
  track.body.half_short_px = {6.0, 0.01, std::nullopt};
  track.body.blur_px = 0.8;
  track.body.contrast_dn = contrast_dn;
  for (int i = 0; i < 20; ++i) {
    Pose pose;
    pose.frame = i;
    pose.centre = {20.0 + i, 20.0 + 0.5 * i};
    pose.angle_rad = 0.1 * i;
    track.poses.push_back(pose);
  }
  return track;
}

Background Flat(float level_dn) {
  Background background;
  background.width_px = 64;
  background.height_px = 48;
  background.level.assign(std::size_t{64} * 48, level_dn);
  return background;
}

// Half of the mean square over log gamma, by a finer sum.
TEST(UnknownShift, IsTheRootMeanSquareOverTheGammasOfCameras) {
  double square = 0.0;
  constexpr int kSteps = 1000;
  for (int i = 0; i < kSteps; ++i) {
    const double gamma = std::pow(kLeastGamma, (i + 0.5) / kSteps);
    const double shift = EdgeShift(130.0, 40.0, 0.8, gamma);
    square += 0.5 * shift * shift / kSteps;
  }
  for (const auto kind :
       {core::BodyKind::kSphere, core::BodyKind::kRectangle}) {
    EXPECT_NEAR(UnknownShift(Flat(130.0F), Seen(kind, -90.0)),
                std::sqrt(square), 0.01 * std::sqrt(square));
  }
}

TEST(UnknownShift, IsNothingWithoutAContrastOrAKnownBackground) {
  EXPECT_NEAR(UnknownShift(Flat(130.0F), Seen(core::BodyKind::kSphere, 0.0)),
              0.0, 1e-12);
  Background unknown = Flat(130.0F);
  unknown.unknown.assign(unknown.level.size(), 1);
  EXPECT_EQ(UnknownShift(unknown, Seen(core::BodyKind::kSphere, -90.0)), 0.0);
}

// Edges before a darker and a brighter wall go opposite ways.
TEST(UnknownShift, CancelsBeforeAWallDarkerAndBrighter) {
  const Track track = Seen(core::BodyKind::kRectangle, 0.0);
  Background striped = Flat(60.0F);
  for (std::size_t i = 0; i < striped.level.size(); i += 2) {
    striped.level[i] = 180.0F;
  }
  EXPECT_LT(UnknownShift(striped, track),
            0.3 * UnknownShift(Flat(60.0F), Seen(track.body.kind, 60.0)));
}

}  // namespace
}  // namespace touchdown::vision
