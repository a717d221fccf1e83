#include "vision/src/tracking/layered_track.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "tests/vision/drawn_block.h"

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
