#include "vision/src/detection/layered_start.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "tests/vision/drawn_block.h"

namespace touchdown::vision {
namespace {

using synthetic::DrawBlock;
using synthetic::DrawnBlock;
using synthetic::SlowBlock;
using synthetic::SlowBlockLikeTheWall;

LayeredStartOptions OptionsFor(const DrawnBlock& block) {
  LayeredStartOptions options;
  options.shape = {core::BodyKind::kRectangle, 2.0 * block.half_long_px,
                   2.0 * block.half_short_px};
  options.threads = 1;
  return options;
}

// Within four pixels and eight degrees of the block in every frame.
void ExpectFollowed(const DrawnBlock& block,
                    const std::vector<StartPose>& poses) {
  ASSERT_EQ(poses.size(), 40U);
  for (const StartPose& pose : poses) {
    const synthetic::BlockPose truth = block.pose(pose.frame);
    EXPECT_TRUE(pose.seen) << pose.frame;
    EXPECT_NEAR(pose.centre.x_px, truth.x_px, 4.0) << pose.frame;
    EXPECT_NEAR(pose.centre.y_px, truth.y_px, 4.0) << pose.frame;
    EXPECT_NEAR(
        std::remainder(pose.angle_rad - truth.angle_rad, std::numbers::pi), 0.0,
        8.0 * std::numbers::pi / 180.0)
        << pose.frame;
  }
}

void ExpectFollowed(const DrawnBlock& block) {
  const auto clip = DrawBlock(block);
  const auto start = FindLayeredStart(*clip, OptionsFor(block));
  ASSERT_TRUE(start) << start.error().reason;
  ExpectFollowed(block, *start);
}

TEST(FindLayeredStart, FollowsABodyThatCoversItsOwnPlace) {
  ExpectFollowed(SlowBlock());
}

// Its middle is covered in all frames, and what it uncovers behind it looks
// like a body that goes the other way.
TEST(FindLayeredStart, FollowsABodyThatGoesAThirdOfItsLength) {
  DrawnBlock block;
  block.half_long_px = 30.0;
  block.half_short_px = 10.0;
  block.pose = [](std::int64_t frame) {
    return synthetic::BlockPose{70.0 + 0.5 * static_cast<double>(frame), 50.0,
                                0.0};
  };
  ExpectFollowed(block);
}

TEST(FindLayeredStart, DoesNotDependOnThreads) {
  const DrawnBlock block = SlowBlock();
  const auto clip = DrawBlock(block);
  LayeredStartOptions options = OptionsFor(block);
  const auto one = FindLayeredStart(*clip, options);
  options.threads = 3;
  const auto three = FindLayeredStart(*clip, options);
  ASSERT_TRUE(one);
  ASSERT_TRUE(three);
  ASSERT_EQ(one->size(), three->size());
  for (std::size_t i = 0; i < one->size(); ++i) {
    EXPECT_EQ((*one)[i].centre.x_px, (*three)[i].centre.x_px);
    EXPECT_EQ((*one)[i].angle_rad, (*three)[i].angle_rad);
    EXPECT_EQ((*one)[i].score, (*three)[i].score);
  }
}

TEST(FindLayeredStart, SaysThatNothingMoves) {
  DrawnBlock block;
  block.pose = [](std::int64_t) {
    return synthetic::BlockPose{90.0, 60.0, 0.2};
  };
  const auto clip = DrawBlock(block);
  const auto start = FindLayeredStart(*clip, OptionsFor(block));
  ASSERT_FALSE(start);
  EXPECT_THAT(start.error().reason, testing::HasSubstr("stated size"));
}

// Successive frames of a codec's clip are more alike than each is to the still
// picture: their differences are no measure of the noise.
TEST(FindLayeredStart, TakesWhatACodecRepeatsForNoise) {
  DrawnBlock block;
  block.noise_dn = 6.0;
  block.noise_lasts = 4;
  block.pose = [](std::int64_t) {
    return synthetic::BlockPose{90.0, 60.0, 0.2};
  };
  const auto start = FindLayeredStart(*DrawBlock(block), OptionsFor(block));
  ASSERT_FALSE(start);
  EXPECT_THAT(start.error().reason, testing::HasSubstr("stated size changes"));
}

TEST(FindLayeredStart, RefusesAShapeWithoutSize) {
  const auto clip = DrawBlock(SlowBlock());
  EXPECT_THROW(FindLayeredStart(*clip, {}), std::invalid_argument);
}

LayeredStartOptions OptionsFor(core::BodyKind kind) {
  LayeredStartOptions options;
  options.shape.kind = kind;
  options.threads = 1;
  return options;
}

// Sides to three cells of 2 px; half of what is drawn on it looks like the
// wall.
TEST(FindSizedStart, FindsSidesThatNobodyStated) {
  const DrawnBlock block = SlowBlockLikeTheWall();
  const auto clip = DrawBlock(block);
  const auto start =
      FindSizedStart(*clip, OptionsFor(core::BodyKind::kRectangle));
  ASSERT_TRUE(start) << start.error().reason;
  EXPECT_NEAR(start->shape.long_side, 2.0 * block.half_long_px, 6.0);
  EXPECT_NEAR(start->shape.short_side, 2.0 * block.half_short_px, 6.0);
  ExpectFollowed(block, start->poses);
  const auto disc = FindSizedStart(*clip, OptionsFor(core::BodyKind::kSphere));
  if (disc) EXPECT_GT(disc->unexplained, 1.1 * start->unexplained);
}

TEST(FindSizedStart, SaysThatNothingMoves) {
  DrawnBlock block;
  block.pose = [](std::int64_t) {
    return synthetic::BlockPose{90.0, 60.0, 0.2};
  };
  EXPECT_FALSE(FindSizedStart(*DrawBlock(block),
                              OptionsFor(core::BodyKind::kRectangle)));
  EXPECT_FALSE(
      FindSizedStart(*DrawBlock(block), OptionsFor(core::BodyKind::kSphere)));
}

}  // namespace
}  // namespace touchdown::vision
