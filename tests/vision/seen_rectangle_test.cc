#include "vision/src/tracking/seen_rectangle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>

#include "tests/vision/drawn_block.h"
#include "touchdown/vision/background/background.h"

namespace touchdown::vision {
namespace {

using synthetic::BlockPose;
using synthetic::DrawBlock;
using synthetic::DrawnBlock;

// A block that is striped, so that its strongest edges are no outline. It
// covers a pixel in less than a quarter of the frames.
DrawnBlock Striped() {
  DrawnBlock block;
  block.half_long_px = 13.0;
  block.pose = [](std::int64_t frame) {
    const auto t = static_cast<double>(frame);
    return BlockPose{40.0 + 3.0 * t, 60.0, 0.005 * t};
  };
  block.face = [](double along, double) {
    return 40.0 * std::sin(0.6 * along);
  };
  return block;
}

// What an outline that was led astray makes of it: turned and moved, with other
// sides.
Track Astray(const DrawnBlock& block, double sides) {
  constexpr double kTurn_rad = 0.12;
  constexpr double kMove_px = 1.5;
  Track track;
  track.body.kind = core::BodyKind::kRectangle;
  track.body.half_long_px = {sides * block.half_long_px, 0.5};
  track.body.half_short_px = {sides * block.half_short_px, 0.5};
  track.last_frame = block.frames;
  for (std::int64_t f = 0; f < block.frames; ++f) {
    const BlockPose at = block.pose(f);
    Pose pose;
    pose.frame = f;
    pose.centre = {at.x_px + kMove_px * std::cos(at.angle_rad),
                   at.y_px + kMove_px * std::sin(at.angle_rad)};
    pose.angle_rad = at.angle_rad + kTurn_rad;
    track.poses.push_back(pose);
  }
  return track;
}

std::optional<SeenRectangle> Take(const DrawnBlock& block, const Track& track) {
  const auto clip = DrawBlock(block);
  return TakeSeenRectangle(*clip, EstimateBackground(*clip, 0, block.frames),
                           track);
}

TEST(TakeSeenRectangle, FindsTheBlockFromAnOutlineThatWasLedAstray) {
  const DrawnBlock block = Striped();
  const auto seen = Take(block, Astray(block, 1.4));
  ASSERT_TRUE(seen);
  EXPECT_FALSE(seen->goes_on);
  EXPECT_NEAR(seen->track.body.half_long_px.value, block.half_long_px, 0.4);
  EXPECT_NEAR(seen->track.body.half_short_px.value, block.half_short_px, 0.4);
  for (const Pose& pose : seen->track.poses) {
    const BlockPose truth = block.pose(pose.frame);
    EXPECT_NEAR(pose.centre.x_px, truth.x_px, 1.0) << pose.frame;
    EXPECT_NEAR(pose.centre.y_px, truth.y_px, 1.0) << pose.frame;
    EXPECT_NEAR(pose.angle_rad, truth.angle_rad, 0.03) << pose.frame;
  }
}

TEST(TakeSeenRectangle, SaysThatABlockGoesOnBeyondATrackTooNarrow) {
  const DrawnBlock block = Striped();
  const auto seen = Take(block, Astray(block, 0.8));
  ASSERT_TRUE(seen);
  EXPECT_TRUE(seen->goes_on);
}

TEST(TakeSeenRectangle, NothingIsSeenWhereNoBodyIs) {
  const DrawnBlock block = Striped();
  Track elsewhere = Astray(block, 0.5);
  for (Pose& pose : elsewhere.poses) pose.centre.y_px = 15.0;
  EXPECT_FALSE(Take(block, elsewhere));
}

}  // namespace
}  // namespace touchdown::vision
