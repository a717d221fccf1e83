#include "vision/src/tracking/follow_in_layers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>

#include "tests/vision/drawn_block.h"
#include "touchdown/vision/footage/linear_clip.h"
#include "touchdown/vision/synthetic/render.h"

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

// From rough poses of all frames.
core::Expected<Track> FollowRoughly(const DrawnBlock& block, Clip& clip) {
  const std::int64_t frames = clip.info().frames;
  return FollowInLayers(clip, EstimateBackground(clip, 0, frames),
                        RoughTrack(block, clip, 0, frames), SizeOf(block), 1);
}

TEST(FollowInLayers, MeasuresRoughPosesAgain) {
  const DrawnBlock block = Passing();
  const auto clip = DrawBlock(block);
  const auto track = FollowRoughly(block, *clip);
  ASSERT_TRUE(track) << track.error().reason;
  EXPECT_TRUE(track->layered);
  EXPECT_TRUE(track->near_ground_modelled);
  EXPECT_EQ(track->poses.size(), static_cast<std::size_t>(block.frames));
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

// As a codec's pictures age: residuals of the last frames are ten times those
// of the known ones, of a body that is well explained all the same.
TEST(FollowInLayers, GoesOnWhereResidualsGrow) {
  DrawnBlock block = Passing();
  block.noise_dn = 1.0;
  block.noise_grows = 0.2;
  const auto clip = DrawBlock(block);
  const std::int64_t frames = clip->info().frames;
  const auto track =
      FollowInLayers(*clip, EstimateBackground(*clip, 0, frames),
                     RoughTrack(block, *clip, 0, 12), SizeOf(block), 1);
  ASSERT_TRUE(track) << track.error().reason;
  EXPECT_EQ(track->poses.back().frame, frames - 1);
}

// What is left where the body was is the still picture, of which the body's own
// explains nothing.
TEST(FollowInLayers, EndsWhereTheBodyIsGone) {
  DrawnBlock block = Passing();
  const auto before = block.pose;
  constexpr std::int64_t kGone = 30;
  block.pose = [before](std::int64_t frame) {
    return frame < kGone ? before(frame) : BlockPose{-500.0, 0.0, 0.0};
  };
  const auto clip = DrawBlock(block);
  const auto track =
      FollowInLayers(*clip, EstimateBackground(*clip, 0, clip->info().frames),
                     RoughTrack(block, *clip, 0, kGone - 8), SizeOf(block), 1);
  ASSERT_TRUE(track) << track.error().reason;
  EXPECT_EQ(track->poses.back().frame, kGone - 1);
}

// A dark block before a bright wall, whose outlines lie far beside it in
// levels of gamma 0.45.
DrawnBlock Dark(double gamma) {
  DrawnBlock block = Passing();
  block.level_dn = 8.0;
  block.gamma = gamma;
  return block;
}

TEST(FollowInLayers, ACamerasGammaIsTakenOut) {
  const DrawnBlock block = Dark(0.45);
  const auto clip = DrawBlock(block);
  const auto track = FollowRoughly(block, *clip);
  ASSERT_TRUE(track) << track.error().reason;
  ASSERT_TRUE(track->body.gamma);
  EXPECT_NEAR(*track->body.gamma, block.gamma, 0.1);
  EXPECT_NEAR(track->body.half_short_px.value, block.half_short_px, 0.1);
  EXPECT_LT(track->body.u_common_px, 0.1);
  ExpectTrue(*track, block, 0.1);
}

TEST(FollowInLayers, ALinearCameraHasNoGamma) {
  const DrawnBlock block = Dark(1.0);
  const auto clip = DrawBlock(block);
  const auto track = FollowRoughly(block, *clip);
  ASSERT_TRUE(track) << track.error().reason;
  EXPECT_FALSE(track->body.gamma);
}

// What a size that is not known owes to the gamma is part of its u.
TEST(FollowInLayers, TheSizeOfABodyThatNobodyMeasured) {
  for (const double gamma : {1.0, 0.45}) {
    DrawnBlock block = Dark(gamma);
    block.face = [](double along, double across) {
      return 60.0 + 25.0 * std::sin(0.8 * along) * std::cos(0.6 * across);
    };
    const auto clip = DrawBlock(block);
    const std::int64_t frames = clip->info().frames;
    const auto track =
        FollowInLayers(*clip, EstimateBackground(*clip, 0, frames),
                       RoughTrack(block, *clip, 0, frames), std::nullopt, 1);
    ASSERT_TRUE(track) << track.error().reason;
    const core::Estimate half_long = HalfLong(track->body);
    const core::Estimate half_short = HalfShort(track->body);
    EXPECT_NEAR(half_long.value, block.half_long_px, 3.0 * half_long.u);
    EXPECT_NEAR(half_short.value, block.half_short_px, 3.0 * half_short.u);
    EXPECT_NEAR(half_long.value, block.half_long_px, 0.15);
    EXPECT_LT(half_long.u, 0.3);
    ExpectTrue(*track, block, 0.15);
  }
}

// Of a linear camera: 0.3 px, which a gamma of 0.6 would explain.
TEST(FollowInLayers, AMisstatedSizeIsNotTakenForAGamma) {
  const DrawnBlock block = Dark(1.0);
  const auto clip = DrawBlock(block);
  const std::int64_t frames = clip->info().frames;
  BodySize size = SizeOf(block);
  size.long_px.value += 0.6;
  size.short_px.value += 0.6;
  const auto track =
      FollowInLayers(*clip, EstimateBackground(*clip, 0, frames),
                     RoughTrack(block, *clip, 0, frames), size, 1);
  ASSERT_TRUE(track) << track.error().reason;
  EXPECT_FALSE(track->body.gamma);
}

// Who states a camera's gamma has light, and no second one is looked for.
TEST(FollowInLayers, AGammaThatWasStatedStays) {
  const DrawnBlock block = Dark(0.45);
  const auto levels = DrawBlock(block);
  const auto clip = ViewInLight(*levels, 0.7);
  const auto track = FollowRoughly(block, *clip);
  ASSERT_TRUE(track) << track.error().reason;
  EXPECT_FALSE(track->body.gamma);
}

// A picture is learned from every second or third frame. Where a blow lies
// between two of them, the others are pixels beside the way from one to the
// next.
TEST(FollowInLayers, FollowsAFaceThroughABlow) {
  for (const double hit : {14.3, 15.3, 16.3}) {
    DrawnBlock block;
    block.width_px = 240;
    block.height_px = 160;
    block.frames = 60;
    block.half_long_px = 20.0;
    block.half_short_px = 12.0;
    block.face = [](double along, double across) {
      return 15.0 * std::sin(0.8 * along) * std::cos(0.6 * across);
    };
    block.pose = [hit](std::int64_t frame) {
      const auto t = static_cast<double>(frame);
      return BlockPose{40.0 + 2.0 * t, 20.0 + 7.0 * std::min(t, hit), 0.2};
    };
    const auto clip = DrawBlock(block);
    const auto track = FollowInLayers(
        *clip, EstimateBackground(*clip, 0, block.frames),
        RoughTrack(block, *clip, 0, block.frames), SizeOf(block), 1);
    ASSERT_TRUE(track) << track.error().reason;
    EXPECT_TRUE(track->textured);
    EXPECT_EQ(track->poses.size(), static_cast<std::size_t>(block.frames));
    ExpectTrue(*track, block, 0.15);
  }
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

// A bright ball of 20 px that passes, and how it turns.
struct PassingBall {
  std::unique_ptr<Clip> clip;
  Track track;
};
PassingBall FilmBall(std::optional<SceneMark> mark, double omega) {
  Scene scene;
  scene.body = core::Sphere({0.04, 0.0});
  scene.camera.width_px = 240;
  scene.camera.height_px = 120;
  scene.camera.ground_point = {120.0, 100.0};
  scene.camera.fps = 1000.0;
  scene.look.body_level = 0.8;
  scene.look.background_level = 0.3;
  scene.look.mark = mark;
  scene.noise = {1.0, 0.02};
  scene.frames = 60;
  scene.pose = [omega](double t) {
    return ScenePose{{-0.08 + 2.6 * t, 0.05}, omega * t};
  };
  PassingBall ball{OpenScene(scene, 3), {}};
  ball.track.body.radius_px = {20.0, 0.01};
  ball.track.body.blur_px = 0.8;
  for (std::int64_t f = 0; f < scene.frames; ++f) {
    Pose pose;
    pose.frame = f;
    pose.centre =
        ToImage(scene.camera,
                scene.pose(static_cast<double>(f) / scene.camera.fps).centre);
    ball.track.poses.push_back(pose);
  }
  return ball;
}

TEST(ShowsMarks, OfABallWithADotThatTurns) {
  const SceneMark dot{0.3, 0.66, 0.15};
  const auto shows = [](const PassingBall& ball) {
    return ShowsMarks(*ball.clip, EstimateBackground(*ball.clip, 0, 60),
                      ball.track);
  };
  EXPECT_TRUE(shows(FilmBall(dot, 60.0)));
  EXPECT_FALSE(shows(FilmBall(dot, 0.0)));
  EXPECT_FALSE(shows(FilmBall(std::nullopt, 60.0)));
  PassingBall block = FilmBall(dot, 60.0);
  block.track.body.kind = core::BodyKind::kRectangle;
  EXPECT_FALSE(shows(block));
}

}  // namespace
}  // namespace touchdown::vision
