#include "vision/src/tracking/take_layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "tests/vision/drawn_block.h"
#include "tests/vision/drawn_clip.h"
#include "touchdown/vision/background/background.h"

namespace touchdown::vision {
namespace {

using synthetic::BlockPose;
using synthetic::DrawBlock;
using synthetic::DrawnBlock;

// A block whose face goes from darker than the wall to brighter and back, so
// that outlines of free size are drawn to what is on it.
DrawnBlock Crossing() {
  DrawnBlock block;
  block.half_long_px = 14.0;
  block.half_short_px = 9.0;
  block.level_dn = 128.0;
  block.pose = [](std::int64_t frame) {
    const auto t = static_cast<double>(frame);
    return BlockPose{30.0 + 3.5 * t, 50.0 + 0.3 * t, 0.02 * t};
  };
  block.face = [](double along, double across) {
    return 70.0 * std::sin(0.35 * along) * std::cos(0.3 * across);
  };
  return block;
}

core::Expected<TrackResult> StartWithSize(const DrawnBlock& block,
                                          double times) {
  TrackOptions options;
  options.kind = core::BodyKind::kRectangle;
  options.size =
      BodySize{{2.0 * times * block.half_long_px, 0.03, std::nullopt},
               {2.0 * times * block.half_short_px, 0.03, std::nullopt}};
  options.threads = 1;
  const auto clip = DrawBlock(block);
  return StartInLayers(*clip, options, block.frames,
                       EstimateBackground(*clip, 0, block.frames));
}

TEST(StartInLayers, BelievesAStatedSizeThatIsSeen) {
  const DrawnBlock block = Crossing();
  const auto started = StartWithSize(block, 1.0);
  ASSERT_TRUE(started) << started.error().reason;
  for (const Pose& pose : started->track.poses) {
    const BlockPose truth = block.pose(pose.frame);
    EXPECT_NEAR(pose.centre.x_px, truth.x_px, 0.1) << pose.frame;
    EXPECT_NEAR(pose.centre.y_px, truth.y_px, 0.1) << pose.frame;
  }
}

TEST(StartInLayers, RefusesABlockOfAnotherSize) {
  const DrawnBlock block = Crossing();
  for (const double times : {0.85, 0.94, 1.06, 1.2}) {
    EXPECT_FALSE(StartWithSize(block, times)) << times;
  }
}

constexpr double kRadius_px = 16.0;
constexpr std::int64_t kFrames = 40;

core::PixelPoint BallCentre(std::int64_t frame) {
  const auto t = static_cast<double>(frame);
  return {40.0 + 3.0 * t, 70.0 - 0.02 * (t - 20.0) * (t - 20.0)};
}

// A ball of another size than was stated. What changes is explained by a larger
// one, too, whose rim looks like the wall.
TEST(StartInLayers, RefusesABallOfAnotherSize) {
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
    EXPECT_FALSE(StartInLayers(clip, options, kFrames,
                               EstimateBackground(clip, 0, kFrames)))
        << share;
  }
}

}  // namespace
}  // namespace touchdown::vision
