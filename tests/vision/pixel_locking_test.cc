// The closed forms against edges that are drawn and fitted: a box of one pixel,
// blurred afterwards, as linear interpolation draws it.
#include "vision/src/contact/pixel_locking.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "touchdown/core/normal.h"

namespace touchdown::vision {
namespace {

constexpr int kReach = 12;  // px on either side of the edge

// By how much the least-squares place of an edge at `x0` is off. `lens_px`: the
// blur after the pixel's box; the edge's own is larger by a twelfth of px^2.
double FitDrawnEdge(double x0, double lens_px) {
  std::array<double, 2 * kReach + 1> levels{};
  for (int x = -kReach; x <= kReach; ++x) {
    double weights = 0.0;
    double sum = 0.0;
    for (int k = -kReach; k <= kReach; ++k) {
      const double weight = std::exp(-0.5 * k * k / (lens_px * lens_px));
      weights += weight;
      sum += weight * std::clamp(0.5 - (x + k - x0), 0.0, 1.0);
    }
    levels[static_cast<std::size_t>(x + kReach)] = sum / weights;
  }
  const double blur = std::sqrt(lens_px * lens_px + 1.0 / 12.0);
  double place = x0;
  for (int step = 0; step < 10; ++step) {
    double gradient = 0.0;
    double curvature = 0.0;
    for (int x = -kReach / 2; x <= kReach / 2; ++x) {
      const double z = (place - x) / blur;
      const double slope =
          std::exp(-0.5 * z * z) / (blur * std::sqrt(2.0 * std::numbers::pi));
      gradient += slope * (levels[static_cast<std::size_t>(x + kReach)] -
                           core::NormalCdf(z));
      curvature += slope * slope;
    }
    place += gradient / curvature;
  }
  return place - x0;
}

// A block on a level ground line, or on one that is inclined by `roll_rad`.
PlaneTrack MakeBlock(double half_long_px, double blur_px, double roll_rad) {
  PlaneTrack track;
  track.kind = core::BodyKind::kRectangle;
  track.half_long_px = half_long_px;
  track.half_short_px = 0.3 * half_long_px;
  track.blur_px = blur_px;
  constexpr double kLength_px = 600.0;
  track.ground = calib::MakeGroundLine(
      {0.0, 300.0}, {kLength_px, 300.0 + kLength_px * std::tan(roll_rad)});
  return track;
}

// Root mean squares of place and slope of one edge, over all its phases.
PixelLocking AverageOverPhases(double lens_px, double half_px, double per_px) {
  constexpr int kPhases = 40;
  double place2 = 0.0;
  double slope2 = 0.0;
  for (int phase = 0; phase < kPhases; ++phase) {
    double sum = 0.0;
    double moment = 0.0;
    double arms = 0.0;
    const int columns = static_cast<int>(half_px);
    for (int x = -columns; x <= columns; ++x) {
      const double x0 = static_cast<double>(phase) / kPhases + per_px * x;
      const double off = FitDrawnEdge(std::remainder(x0, 1.0), lens_px);
      sum += off;
      moment += off * x;
      arms += static_cast<double>(x) * x;
    }
    place2 += std::pow(sum / (2 * columns + 1), 2) / kPhases;
    slope2 += std::pow(moment / arms, 2) / kPhases;
  }
  return {std::sqrt(place2), std::sqrt(slope2)};
}

TEST(PixelLocking, IsThatOfDrawnEdges) {
  for (const double lens_px : {0.6, 0.9, 1.4}) {
    const double blur = std::sqrt(lens_px * lens_px + 1.0 / 12.0);
    for (const double roll_rad : {0.0, 0.004, 0.01}) {
      const PlaneTrack block = MakeBlock(26.0, blur, roll_rad);
      const PixelLocking drawn =
          AverageOverPhases(lens_px, 26.0, std::tan(roll_rad));
      const PixelLocking told = EstimatePixelLocking(block, 0.0);
      // Two edges: 1 / sqrt(2) of one.
      EXPECT_NEAR(told.place_px, drawn.place_px / std::numbers::sqrt2,
                  0.1 * told.place_px);
      EXPECT_NEAR(told.face_rad, drawn.face_rad / std::numbers::sqrt2,
                  0.1 * told.face_rad + 1e-9);
    }
  }
}

TEST(PixelLocking, CountsFromThePixelsRowsNotFromTheGround) {
  constexpr double kRoll_rad = 0.02;
  PlaneTrack block = MakeBlock(30.0, 1.0, kRoll_rad);
  const double aligned = EstimatePixelLocking(block, kRoll_rad).place_px;
  const double on_ground = EstimatePixelLocking(block, 0.0).place_px;
  EXPECT_GT(aligned, 3.0 * on_ground);
  block.direction = -1;  // a face that is seen from the other side
  EXPECT_NEAR(EstimatePixelLocking(block, -kRoll_rad).place_px, aligned, 1e-9);
  // Columns are as good as rows.
  EXPECT_NEAR(
      EstimatePixelLocking(block, -kRoll_rad + 0.5 * std::numbers::pi).place_px,
      aligned, 1e-6);
}

TEST(PixelLocking, FallsWithTheAngleToTheRows) {
  const PlaneTrack block = MakeBlock(30.0, 1.0, 0.0);
  const PixelLocking flat = EstimatePixelLocking(block, 0.01);
  const PixelLocking steep = EstimatePixelLocking(block, 0.5);
  EXPECT_LT(steep.place_px, 0.05 * flat.place_px);
  EXPECT_LT(steep.face_rad, 0.1 * flat.face_rad);
}

TEST(PixelLocking, IsNotToldOfASphereOrAnUnknownBlur) {
  PlaneTrack body = MakeBlock(30.0, 0.0, 0.0);
  EXPECT_EQ(EstimatePixelLocking(body, 0.0).place_px, 0.0);
  body.blur_px = 1.0;
  body.kind = core::BodyKind::kSphere;
  EXPECT_EQ(EstimatePixelLocking(body, 0.0).face_rad, 0.0);
}

}  // namespace
}  // namespace touchdown::vision
