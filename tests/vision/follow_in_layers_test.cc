#include "vision/src/tracking/follow_in_layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>

#include "tests/vision/drawn_block.h"

namespace touchdown::vision {
namespace {

using synthetic::BlockPose;
using synthetic::DrawBlock;
using synthetic::DrawnBlock;

DrawnBlock Passing() {
  DrawnBlock block;
  block.pose = [](std::int64_t frame) {
    const auto t = static_cast<double>(frame);
    return BlockPose{60.0 + 2.0 * t, 70.0 - 0.01 * (t - 20.0) * (t - 20.0),
                     0.01 * (t - 20.0)};
  };
  return block;
}

// Rough poses of frames [first, last), as outlines beside a ghost would be.
Track RoughTrack(const DrawnBlock& block, const Clip& clip, std::int64_t first,
                 std::int64_t last) {
  Track track;
  track.body.kind = core::BodyKind::kRectangle;
  track.body.half_long_px = {block.half_long_px, 0.1, std::nullopt};
  track.body.half_short_px = {block.half_short_px, 0.1, std::nullopt};
  track.body.blur_px = 1.0;
  track.body.contrast_dn = 80.0;
  track.last_frame = clip.info().frames;
  track.frame_interval_s = 1.0 / clip.info().time_base.fps;
  for (std::int64_t f = first; f < last; ++f) {
    const BlockPose truth = block.pose(f);
    Pose pose;
    pose.frame = f;
    pose.centre = {truth.x_px + (f % 2 == 0 ? 0.7 : -0.5),
                   truth.y_px + (f % 3 == 0 ? 0.6 : -0.3)};
    pose.angle_rad = truth.angle_rad + (f % 2 == 0 ? 0.02 : -0.01);
    track.poses.push_back(pose);
  }
  return track;
}

void ExpectTrue(const Track& track, const DrawnBlock& block, double most_px) {
  for (const Pose& pose : track.poses) {
    const BlockPose truth = block.pose(pose.frame);
    EXPECT_NEAR(pose.centre.x_px, truth.x_px, most_px) << pose.frame;
    EXPECT_NEAR(pose.centre.y_px, truth.y_px, most_px) << pose.frame;
    EXPECT_NEAR(
        std::remainder(pose.angle_rad - truth.angle_rad, std::numbers::pi), 0.0,
        most_px / block.half_short_px)
        << pose.frame;
    EXPECT_GT(pose.u_x_px, 0.0);
    EXPECT_LT(pose.u_x_px, most_px);
  }
}

BodySize SizeOf(const DrawnBlock& block) {
  return {{2.0 * block.half_long_px, 0.05, std::nullopt},
          {2.0 * block.half_short_px, 0.05, std::nullopt}};
}

TEST(FollowInLayers, MeasuresRoughPosesAgain) {
  const DrawnBlock block = Passing();
  const auto clip = DrawBlock(block);
  const std::int64_t frames = clip->info().frames;
  const auto track =
      FollowInLayers(*clip, EstimateBackground(*clip, 0, frames),
                     RoughTrack(block, *clip, 0, frames), SizeOf(block), 1);
  ASSERT_TRUE(track) << track.error().reason;
  EXPECT_TRUE(track->layered);
  EXPECT_TRUE(track->near_ground_modelled);
  EXPECT_EQ(track->poses.size(), static_cast<std::size_t>(frames));
  ExpectTrue(*track, block, 0.1);
}

TEST(FollowInLayers, GoesOnBeyondBothEnds) {
  const DrawnBlock block = Passing();
  const auto clip = DrawBlock(block);
  const std::int64_t frames = clip->info().frames;
  const auto track =
      FollowInLayers(*clip, EstimateBackground(*clip, 0, frames),
                     RoughTrack(block, *clip, 6, frames - 8), SizeOf(block), 1);
  ASSERT_TRUE(track) << track.error().reason;
  EXPECT_EQ(track->poses.front().frame, 0);
  EXPECT_EQ(track->poses.back().frame, frames - 1);
  ExpectTrue(*track, block, 0.1);
}

TEST(FollowInLayers, ABodyThatComesMuchNearerIsNone) {
  const DrawnBlock block = Passing();
  const auto clip = DrawBlock(block);
  const std::int64_t frames = clip->info().frames;
  Track track = RoughTrack(block, *clip, 0, frames);
  track.poses.back().relative_size = 1.05;
  const auto followed = FollowInLayers(
      *clip, EstimateBackground(*clip, 0, frames), track, std::nullopt, 1);
  ASSERT_FALSE(followed);
  EXPECT_NE(followed.error().reason.find("does not keep its size"),
            std::string::npos);
}

TEST(NeedsLayers, WhereTheBackgroundOrTheOutlineIsADoubtfulWitness) {
  Track track;
  Pose pose;
  pose.misfit = 1.0;
  track.poses.assign(5, pose);
  EXPECT_FALSE(NeedsLayers(track, 0.1));
  EXPECT_TRUE(NeedsLayers(track, 0.3));
  track.known_background = false;
  EXPECT_TRUE(NeedsLayers(track, 0.1));
  track.known_background = true;
  for (Pose& each : track.poses) each.misfit = 1.5;
  EXPECT_TRUE(NeedsLayers(track, 0.1));
}

}  // namespace
}  // namespace touchdown::vision
