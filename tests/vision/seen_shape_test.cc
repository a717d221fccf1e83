#include "vision/src/tracking/seen_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "tests/vision/drawn_block.h"
#include "tests/vision/drawn_clip.h"
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

// A track on the block's own poses, whose half sides are `off_px` too large.
Track OnTheBlock(const DrawnBlock& block, double off_px) {
  Track track;
  track.body.kind = core::BodyKind::kRectangle;
  track.body.half_long_px = {block.half_long_px + off_px, 0.5};
  track.body.half_short_px = {block.half_short_px + off_px, 0.5};
  track.last_frame = block.frames;
  for (std::int64_t f = 0; f < block.frames; ++f) {
    const BlockPose at = block.pose(f);
    Pose pose;
    pose.frame = f;
    pose.centre = {at.x_px, at.y_px};
    pose.angle_rad = at.angle_rad;
    track.poses.push_back(pose);
  }
  return track;
}

TEST(MeasureSeenSides, FindsTheSidesOfABlockWhateverIsDrawnOnIt) {
  const DrawnBlock block = Striped();
  const auto clip = DrawBlock(block);
  const Background behind = EstimateBackground(*clip, 0, block.frames);
  for (const double off_px : {-1.0, 0.0, 1.0}) {
    SCOPED_TRACE(off_px);
    const auto seen =
        MeasureSeenSides(*clip, behind, OnTheBlock(block, off_px));
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->half_long_px, block.half_long_px, 0.4);
    EXPECT_NEAR(seen->half_short_px, block.half_short_px, 0.4);
  }
}

TEST(MeasureSeenSides, FindsTheRadiusOfABall) {
  constexpr double kRadius_px = 14.0;
  constexpr std::int64_t kFrames = 40;
  const auto centre = [](std::int64_t frame) {
    return core::PixelPoint{30.0 + 3.5 * static_cast<double>(frame), 60.0};
  };
  // Brighter than the wall at one end and darker at the other.
  const auto draw = [&](std::int64_t frame, std::vector<double>& levels) {
    const core::PixelPoint at = centre(frame);
    for (std::int32_t y = 0; y < 120; ++y) {
      for (std::int32_t x = 0; x < 200; ++x) {
        const double depth = kRadius_px - std::hypot(x - at.x_px, y - at.y_px);
        const double cover = 0.5 * (1.0 + std::erf(depth / 1.1));
        levels.push_back(120.0 + 4.0 * cover * (x - at.x_px));
      }
    }
  };
  synthetic::DrawnClip clip(200, 120, kFrames, 1000.0, draw);
  Track track;
  track.body.kind = core::BodyKind::kSphere;
  track.last_frame = kFrames;
  for (std::int64_t f = 0; f < kFrames; ++f) {
    Pose pose;
    pose.frame = f;
    pose.centre = centre(f);
    track.poses.push_back(pose);
  }
  const Background behind = EstimateBackground(clip, 0, kFrames);
  // Where layers settled on a wrong edge at one end, the centre is off, too.
  for (const double off_centre_px : {0.0, 1.2}) {
    for (Pose& pose : track.poses) {
      pose.centre = centre(pose.frame);
      pose.centre.x_px += off_centre_px;
    }
    for (const double off_px : {-1.0, 0.0, 1.0}) {
      SCOPED_TRACE(off_px);
      SCOPED_TRACE(off_centre_px);
      track.body.radius_px = {kRadius_px + off_px, 0.5};
      const auto seen = MeasureSeenSides(clip, behind, track);
      ASSERT_TRUE(seen);
      EXPECT_NEAR(seen->half_long_px, kRadius_px, 0.3);
    }
  }
}

TEST(MeasureSeenSides, NothingIsSeenWhereNoBodyIs) {
  const DrawnBlock block = Striped();
  Track elsewhere = OnTheBlock(block, 0.0);
  for (Pose& pose : elsewhere.poses) pose.centre.y_px = 15.0;
  const auto clip = DrawBlock(block);
  EXPECT_FALSE(MeasureSeenSides(
      *clip, EstimateBackground(*clip, 0, block.frames), elsewhere));
}

}  // namespace
}  // namespace touchdown::vision
