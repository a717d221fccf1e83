#include "vision/src/tracking/layered_track.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "tests/vision/drawn_block.h"
#include "tests/vision/drawn_clip.h"

namespace touchdown::vision {
namespace {

using synthetic::BlockPose;
using synthetic::DrawBlock;
using synthetic::DrawnBlock;
using synthetic::SlowBlock;
using synthetic::SlowBlockLikeTheWall;

TrackOptions OptionsFor(const DrawnBlock& block) {
  TrackOptions options;
  options.kind = core::BodyKind::kRectangle;
  options.size = BodySize{{2.0 * block.half_long_px, 0.05, std::nullopt},
                          {2.0 * block.half_short_px, 0.05, std::nullopt}};
  options.threads = 1;
  return options;
}

// Its sides, and its pose in nearly every frame.
void ExpectFound(const Track& track, const DrawnBlock& block) {
  ASSERT_EQ(track.body.kind, core::BodyKind::kRectangle);
  EXPECT_NEAR(track.body.half_long_px.value, block.half_long_px, 0.2);
  EXPECT_NEAR(track.body.half_short_px.value, block.half_short_px, 0.2);
  EXPECT_GE(track.poses.size(), 36U);
  for (const Pose& pose : track.poses) {
    const BlockPose truth = block.pose(pose.frame);
    EXPECT_NEAR(pose.centre.x_px, truth.x_px, 0.3) << pose.frame;
    EXPECT_NEAR(pose.centre.y_px, truth.y_px, 0.3) << pose.frame;
    EXPECT_NEAR(
        std::remainder(pose.angle_rad - truth.angle_rad, std::numbers::pi), 0.0,
        0.02)
        << pose.frame;
  }
}

TEST(TrackBody, FollowsABodyOfKnownSizeThatCoversItsOwnPlace) {
  const DrawnBlock block = SlowBlock();
  const auto result = TrackBody(*DrawBlock(block), OptionsFor(block));
  ASSERT_TRUE(result) << result.error().reason;
  ExpectFound(result->track, block);
}

TEST(TrackBody, FindsABlockOfNoStatedSizeThatLooksLikeTheWallInPart) {
  const DrawnBlock block = SlowBlockLikeTheWall();
  TrackOptions options;
  options.threads = 1;
  const auto result = TrackBody(*DrawBlock(block), options);
  ASSERT_TRUE(result) << result.error().reason;
  ExpectFound(result->track, block);
}

constexpr double kRadius_px = 16.0;
constexpr std::int64_t kFrames = 40;

core::PixelPoint BallCentre(std::int64_t frame) {
  const auto t = static_cast<double>(frame);
  return {40.0 + 3.0 * t, 70.0 - 0.02 * (t - 20.0) * (t - 20.0)};
}

// A ball of another size than was stated. What changes is explained by a larger
// one, too, whose rim looks like the wall: its outline is not.
TEST(TrackFromLayers, RefusesASizeThatOutlinesDoNotShow) {
  for (const double share : {0.8, 0.9, 1.2}) {
    const auto draw = [=](std::int64_t frame, std::vector<double>& levels) {
      const core::PixelPoint centre = BallCentre(frame);
      for (std::int32_t y = 0; y < 120; ++y) {
        for (std::int32_t x = 0; x < 200; ++x) {
          const double depth =
              share * kRadius_px - std::hypot(x - centre.x_px, y - centre.y_px);
          // An edge's blur of 0.8 px.
          const double cover =
              0.5 * (1.0 + std::erf(depth / (0.8 * std::numbers::sqrt2)));
          const double noise =
              2.0 * synthetic::HashNoise(static_cast<std::uint32_t>(x),
                                         static_cast<std::uint32_t>(y),
                                         static_cast<std::uint32_t>(frame));
          levels.push_back(150.0 - 90.0 * cover + noise);
        }
      }
    };
    synthetic::DrawnClip clip(200, 120, kFrames, 1000.0, draw);
    TrackOptions options;
    options.kind = core::BodyKind::kSphere;
    options.size = BodySize{{2.0 * kRadius_px, 0.03, std::nullopt}, {}};
    options.threads = 1;
    EXPECT_FALSE(TrackFromLayers(clip, options, kFrames,
                                 EstimateBackground(clip, 0, kFrames)))
        << share;
  }
}

TEST(MayFollowGhost, NeedsAStatedSize) {
  const DrawnBlock block = SlowBlock();
  const auto clip = DrawBlock(block);
  Track track;
  track.last_frame = clip->info().frames;
  TrackOptions options = OptionsFor(block);
  EXPECT_TRUE(MayFollowGhost(*clip, options, track, 0.9));
  options.size.reset();
  EXPECT_FALSE(MayFollowGhost(*clip, options, track, 0.9));
}

}  // namespace
}  // namespace touchdown::vision
