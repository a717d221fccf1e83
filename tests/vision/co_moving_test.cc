#include "vision/src/tracking/co_moving.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/vision/drawn_clip.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {
namespace {

constexpr int kSize_px = 120;
constexpr int kFrames = 40;
constexpr int kHalf_px = 10;  // of a dark square

core::PixelPoint CentreAt(std::int64_t frame) {
  return {25.0 + 1.5 * static_cast<double>(frame), 60.0};
}

// A dark square passes before stripes that stand upright.
void DrawFrame(std::int64_t index, std::vector<double>& levels) {
  const core::PixelPoint c = CentreAt(index);
  for (int y = 0; y < kSize_px; ++y) {
    for (int x = 0; x < kSize_px; ++x) {
      const bool body =
          std::abs(x - c.x_px) <= kHalf_px && std::abs(y - c.y_px) <= kHalf_px;
      const double wall = y < 30 ? 150.0 : 150.0 + 40.0 * std::sin(0.4 * x);
      levels.push_back(body ? 30.0 : wall);
    }
  }
}

class Drawn : public synthetic::DrawnClip {
 public:
  Drawn() : DrawnClip(kSize_px, kSize_px, kFrames, 100.0, DrawFrame) {}
};

Track Path() {
  Track track;
  for (std::int64_t f = 0; f < kFrames; ++f) {
    Pose pose;
    pose.frame = f;
    pose.centre = CentreAt(f);
    track.poses.push_back(pose);
  }
  return track;
}

CoMoving Look(const CoMovingOptions& options) {
  Drawn clip;
  Background noise;
  return FindCoMoving(
      clip, noise, Path(),
      [](const CoMoving& places) {
        std::vector<unsigned char> cover;
        for (int y = -places.half; y <= places.half; ++y) {
          for (int x = -places.half; x <= places.half; ++x) {
            cover.push_back(std::max(std::abs(x), std::abs(y)) < 13);
          }
        }
        return cover;
      },
      options);
}

int SaysAt(const CoMoving& places, int x, int y) {
  return places.says[static_cast<std::size_t>(
      (y + places.half) * places.size() + x + places.half)];
}

TEST(FindCoMoving, TellsTheBodyFromStripesAndNothingOfASmoothWall) {
  CoMovingOptions options;
  options.reach_px = 40.0;
  const CoMoving places = Look(options);
  ASSERT_EQ(places.half, 40);
  EXPECT_EQ(SaysAt(places, 0, 0), 1);
  EXPECT_EQ(SaysAt(places, 9, -9), 1);
  EXPECT_EQ(SaysAt(places, 0, 25), -1);
  EXPECT_EQ(SaysAt(places, 0, -35), 0);
}

TEST(FindCoMoving, WhatIsBelowTheGroundDoesNotMoveAlong) {
  CoMovingOptions options;
  options.reach_px = 40.0;
  options.ground = calib::MakeGroundLine({0.0, 65.0}, {100.0, 65.0});
  const CoMoving places = Look(options);
  EXPECT_EQ(SaysAt(places, 0, 0), 1);
  EXPECT_EQ(SaysAt(places, 0, 8), -1);
}

TEST(FindCoMoving, NothingOfAShortPath) {
  Drawn clip;
  Track path = Path();
  path.poses.resize(4);
  const CoMoving places = FindCoMoving(
      clip, {}, path,
      [](const CoMoving&) { return std::vector<unsigned char>(); }, {});
  EXPECT_TRUE(places.says.empty());
}

}  // namespace
}  // namespace touchdown::vision
