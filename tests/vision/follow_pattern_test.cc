#include "vision/src/tracking/follow_pattern.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "tests/support/statistics.h"
#include "tests/vision/drawn_clip.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {
namespace {

using touchdown::testing::Rms;

constexpr std::int32_t kWidth_px = 240;
constexpr std::int32_t kHeight_px = 120;
constexpr std::int64_t kFrames = 40;
constexpr double kNoise_dn = 1.5;

// 0 below, 1 above an edge at 0 with a blur of 0.8 px.
double Edge(double depth_px) {
  return 0.5 * std::erfc(-depth_px / 0.8 / std::sqrt(2.0));
}

// A ramp runs along the path: a bright wall above its edge, dark below.
constexpr double kSlope = 0.15;
double RampAt(double x_px) { return 72.0 + kSlope * x_px; }
double BackgroundAt(double x, double y) {
  const double below = Edge(y - RampAt(x));
  const double stripes = 12.0 * std::sin(0.12 * x);
  return (150.0 + 0.1 * x + stripes) * (1.0 - below) + 60.0 * below;
}

// The body's level over what is behind it, at (x, y) px from its centre.
using Look =
    std::function<double(double x, double y, double angle, double behind_dn)>;

// A drum seen a little from above: a white face, a gray side behind it, a dark
// mark that turns.
double Drum(double x, double y, double angle, double behind_dn) {
  const auto over = [](double cover, double level, double under) {
    return under + cover * (level - under);
  };
  const double side = Edge(15.0 - std::hypot(x + 1.0, y + 3.0));
  const double face = Edge(13.0 - std::hypot(x, y));
  const double u = x * std::cos(angle) + y * std::sin(angle);
  const double v = y * std::cos(angle) - x * std::sin(angle);
  const double mark = Edge(2.0 - std::abs(v)) * Edge(u) * Edge(11.0 - u);
  return over(mark, 20.0, over(face, 225.0, over(side, 130.0, behind_dn)));
}

// A ball that is lit from above, with a dark spot and a bright one.
double LitBall(double x, double y, double /*angle*/, double behind_dn) {
  const double spots = 40.0 * Edge(3.0 - std::hypot(x + 5.0, y - 2.0)) -
                       30.0 * Edge(2.0 - std::hypot(x - 4.0, y + 4.0));
  return behind_dn +
         Edge(13.0 - std::hypot(x, y)) * (185.0 - 3.0 * y - spots - behind_dn);
}

// Two dark ends, and between them a bar as bright as the wall.
double Cart(double x, double y, double angle, double behind_dn) {
  const double u = x * std::cos(angle) + y * std::sin(angle);
  const double v = y * std::cos(angle) - x * std::sin(angle);
  const double end = Edge(4.0 - std::abs(std::abs(u) - 16.0));
  const double bar = Edge(20.0 - std::abs(u)) * Edge(7.0 - std::abs(v));
  return behind_dn + bar * (160.0 + end * (40.0 - 160.0) - behind_dn);
}

struct Film {
  Look look = Drum;
  std::int64_t frames = kFrames;
  double speed_px = 3.3;      // a frame
  double faster_px = 0.04;    // a frame
  double hop_px = 0.0;        // half way, over seven frames
  double turn_rad = 0.0;      // a frame
  double inclined_rad = 0.0;  // at first; what does neither turn rolls
  double above_px = 13.0;     // the centre above the ramp
  // What the light gains from the body's middle to its upper rim, from the
  // first frame to the last.
  double light_rises_dn = 0.0;
};

Pose TrueAt(const Film& film, std::int64_t frame) {
  Pose pose;
  const auto f = static_cast<double>(frame);
  pose.frame = frame;
  pose.time_s = f / 1000.0;
  pose.centre.x_px = 30.0 + film.speed_px * f + 0.5 * film.faster_px * f * f;
  pose.centre.y_px = RampAt(pose.centre.x_px) - film.above_px;
  if (frame > 16 && frame < 24) pose.centre.y_px -= film.hop_px;
  pose.angle_rad = film.inclined_rad + film.turn_rad * f;
  return pose;
}

void DrawFrame(const Film& film, std::uint64_t seed, std::int64_t index,
               std::vector<double>& levels) {
  std::mt19937_64 engine(seed + static_cast<std::uint64_t>(index));
  std::normal_distribution<double> noise(0.0, kNoise_dn);
  const Pose pose = TrueAt(film, index);
  const double angle =
      pose.angle_rad != 0.0 ? pose.angle_rad : (pose.centre.x_px - 30.0) / 15.0;
  for (int y = 0; y < kHeight_px; ++y) {
    for (int x = 0; x < kWidth_px; ++x) {
      const double right = x - pose.centre.x_px;
      const double down = y - pose.centre.y_px;
      const double cover = 1.0 - film.look(right, down, angle, 1.0) +
                           film.look(right, down, angle, 0.0);
      const double light =
          film.light_rises_dn *
          (static_cast<double>(index) / static_cast<double>(kFrames) - 0.5) *
          -down / 13.0;
      const double level = film.look(right, down, angle, BackgroundAt(x, y)) +
                           cover * light + noise(engine);
      levels.push_back(level);
    }
  }
}

class Drawn : public synthetic::DrawnClip {
 public:
  Drawn(const Film& film, std::uint64_t seed)
      : DrawnClip(
            kWidth_px, kHeight_px, film.frames, 1000.0,
            [film, seed](std::int64_t frame, std::vector<double>& levels) {
              DrawFrame(film, seed, frame, levels);
            }) {}
};

Background Behind() {
  Background background;
  background.width_px = kWidth_px;
  background.height_px = kHeight_px;
  background.noise_floor_dn2 = kNoise_dn * kNoise_dn;
  for (int y = 0; y < kHeight_px; ++y) {
    for (int x = 0; x < kWidth_px; ++x) {
      background.level.push_back(static_cast<float>(BackgroundAt(x, y)));
    }
  }
  return background;
}

// What outlines make of such a body: they wander, and say so by their misfit.
Track Wandering(const Film& film, core::BodyKind kind) {
  Track track;
  track.body.kind = kind;
  track.body.radius_px = {14.0, 0.2};
  track.body.half_long_px = {20.0, 0.2};
  track.body.half_short_px = {7.0, 0.2};
  track.first_frame = 0;
  track.last_frame = film.frames;
  track.frame_interval_s = 1e-3;
  std::mt19937_64 engine(5);
  std::normal_distribution<double> noise(0.0, 0.4);
  for (std::int64_t f = 0; f < film.frames; ++f) {
    Pose pose = TrueAt(film, f);
    pose.centre.x_px +=
        0.5 * std::sin(0.4 * static_cast<double>(f)) + noise(engine);
    pose.centre.y_px +=
        0.5 * std::cos(0.3 * static_cast<double>(f)) + noise(engine);
    pose.angle_rad += 0.02 * noise(engine);
    pose.u_x_px = pose.u_y_px = 0.02;
    pose.misfit = 5.0;
    track.poses.push_back(pose);
  }
  return track;
}

// Errors but for the mean: where the pattern lies on the body is told by the
// outlines.
struct Errors {
  std::vector<double> x, y, angle;
};
Errors ErrorsOf(const Track& track, const Film& film) {
  Errors e;
  for (const Pose& pose : track.poses) {
    const Pose truth = TrueAt(film, pose.frame);
    e.x.push_back(pose.centre.x_px - truth.centre.x_px);
    e.y.push_back(pose.centre.y_px - truth.centre.y_px);
    e.angle.push_back(pose.angle_rad - truth.angle_rad);
  }
  for (auto* v : {&e.x, &e.y, &e.angle}) {
    double mean = 0.0;
    for (const double value : *v) {
      mean += value / static_cast<double>(v->size());
    }
    for (double& value : *v) value -= mean;
  }
  return e;
}

TEST(FollowPattern, ADrumIsFollowedBehindWhichAnEdgePasses) {
  const Film film;
  Drawn clip(film, 1);
  const Track track = FollowPattern(
      clip, Behind(), Wandering(film, core::BodyKind::kSphere), 1);
  ASSERT_TRUE(track.patterned);
  ASSERT_EQ(track.poses.size(), static_cast<std::size_t>(kFrames));
  const Errors errors = ErrorsOf(track, film);
  EXPECT_LT(Rms(errors.x), 0.03);
  EXPECT_LT(Rms(errors.y), 0.03);
  EXPECT_EQ(track.poses[7].time_s, TrueAt(film, 7).time_s);
}

// The ramp's edge looks the same along the whole path: taken for a part of the
// body it would hold it down.
TEST(FollowPattern, AnEdgeAlongThePathDoesNotHideAHop) {
  Film film;
  film.look = Cart;
  film.inclined_rad = std::atan(kSlope);
  film.above_px = 8.0;
  for (const double hop_px : {0.1, 0.2, 1.5}) {
    film.hop_px = hop_px;
    Drawn clip(film, 2);
    const Track track = FollowPattern(
        clip, Behind(), Wandering(film, core::BodyKind::kRectangle), 1);
    ASSERT_TRUE(track.patterned);
    double in_hop = 0.0;
    double beside = 0.0;
    for (const Pose& pose : track.poses) {
      const double off =
          pose.centre.y_px - TrueAt(film, pose.frame).centre.y_px;
      const bool is_hop = pose.frame > 16 && pose.frame < 24;
      (is_hop ? in_hop : beside) += off / (is_hop ? 7.0 : kFrames - 7.0);
    }
    EXPECT_NEAR(in_hop, beside, 0.02) << hop_px;
  }
}

// As a body falls, its light comes more and more from above.
TEST(FollowPattern, LightFromAnotherSideDoesNotMoveIt) {
  Film film;
  film.look = LitBall;
  film.light_rises_dn = 20.0;
  Drawn clip(film, 7);
  const Track track = FollowPattern(
      clip, Behind(), Wandering(film, core::BodyKind::kSphere), 1);
  ASSERT_TRUE(track.patterned);
  EXPECT_LT(Rms(ErrorsOf(track, film).y), 0.06);
}

TEST(FollowPattern, FramesThatOutlinesLostAreFound) {
  const Film film;
  Drawn clip(film, 3);
  Track given = Wandering(film, core::BodyKind::kSphere);
  std::erase_if(given.poses, [](const Pose& pose) {
    return pose.frame < 4 || pose.frame > 35 ||
           (pose.frame > 18 && pose.frame < 22);
  });
  const Track track = FollowPattern(clip, Behind(), given, 1);
  ASSERT_EQ(track.poses.size(), static_cast<std::size_t>(kFrames));
  EXPECT_LT(Rms(ErrorsOf(track, film).y), 0.03);
}

// It goes 3.4 px farther in each frame than in the one before.
TEST(FollowPattern, TheEndOfAFallIsFound) {
  Film film;
  film.frames = 11;
  film.speed_px = 0.5;
  film.faster_px = 3.4;
  Drawn clip(film, 8);
  Track given = Wandering(film, core::BodyKind::kSphere);
  given.poses.resize(9);
  const Track track = FollowPattern(clip, Behind(), given, 1);
  ASSERT_EQ(track.poses.size(), 11u);
  EXPECT_LT(Rms(ErrorsOf(track, film).x), 0.05);
}

TEST(FollowPattern, ABlockOfSeveralPartsIsFollowedAsItTurns) {
  Film film;
  film.look = Cart;
  film.turn_rad = 0.012;
  Drawn clip(film, 4);
  const Track track = FollowPattern(
      clip, Behind(), Wandering(film, core::BodyKind::kRectangle), 1);
  ASSERT_TRUE(track.patterned);
  const Errors errors = ErrorsOf(track, film);
  EXPECT_LT(Rms(errors.x), 0.03);
  EXPECT_LT(Rms(errors.y), 0.03);
  EXPECT_LT(Rms(errors.angle), 2e-3);
}

TEST(FollowPattern, WhatIsWellModelledOrBeforeTheUnknownStaysAsItIs) {
  const Film film;
  Drawn clip(film, 5);
  Track given = Wandering(film, core::BodyKind::kSphere);
  given.known_background = false;
  EXPECT_FALSE(FollowPattern(clip, Behind(), given, 1).patterned);
  given.known_background = true;
  for (Pose& pose : given.poses) pose.misfit = 1.1;
  const Track same = FollowPattern(clip, Behind(), given, 1);
  EXPECT_FALSE(same.patterned);
  EXPECT_EQ(same.poses[3].centre.x_px, given.poses[3].centre.x_px);
}

TEST(FollowPattern, DoesNotDependOnThreads) {
  const Film film;
  const Track given = Wandering(film, core::BodyKind::kSphere);
  Drawn clip(film, 6);
  const Track one = FollowPattern(clip, Behind(), given, 1);
  const Track four = FollowPattern(clip, Behind(), given, 4);
  ASSERT_EQ(one.poses.size(), four.poses.size());
  for (std::size_t i = 0; i < one.poses.size(); ++i) {
    EXPECT_EQ(one.poses[i].centre.y_px, four.poses[i].centre.y_px);
  }
}

// Its outlines say where the pattern lies on the body, on the whole; how it
// moves the pattern says.
TEST(AlignToOutlines, ShiftsAllPosesAlike) {
  const Film film;
  Track outlines = Wandering(film, core::BodyKind::kSphere);
  Track patterned = outlines;
  for (Pose& pose : patterned.poses) {
    pose.centre = TrueAt(film, pose.frame).centre;
    pose.centre.y_px += 3.0;
  }
  const Track put = AlignToOutlines(outlines, patterned);
  const Errors errors = ErrorsOf(put, film);
  EXPECT_LT(Rms(errors.y), 1e-9);
  EXPECT_NEAR(put.poses[9].centre.y_px, TrueAt(film, 9).centre.y_px, 0.3);
}

}  // namespace
}  // namespace touchdown::vision
