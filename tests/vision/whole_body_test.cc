#include "vision/src/tracking/whole_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "tests/vision/drawn_clip.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {
namespace {

constexpr std::int32_t kWidth_px = 260;
constexpr std::int32_t kHeight_px = 120;
constexpr std::int64_t kFrames = 48;
constexpr double kNoise_dn = 1.5;
constexpr double kInclined_rad = 0.15;
constexpr double kHalfLong_px = 24.0;
constexpr double kHalfShort_px = 8.0;

// 0 below, 1 above an edge at 0 with a blur of 0.8 px.
double Edge(double depth_px) {
  return 0.5 * std::erfc(-depth_px / 0.8 / std::sqrt(2.0));
}

double RampAt(double x_px) { return 80.0 + std::tan(kInclined_rad) * x_px; }
double BackgroundAt(double x, double y) {
  const double below = Edge(y - RampAt(x));
  return (150.0 + 0.1 * x) * (1.0 - below) + 60.0 * below;
}

struct Film {
  bool parts = true;        // else a smooth dark block of one part
  bool reflects = false;    // the ramp shows the block upside down
  double turn_rad = 0.0;    // a frame
  std::int64_t stay = 0;    // frames in which it rests at the end
  double end_x_px = -18.0;  // the followed end, from the centre
};

Pose TrueAt(const Film& film, std::int64_t frame) {
  Pose pose;
  const auto f = static_cast<double>(std::min(frame, kFrames - film.stay));
  pose.frame = frame;
  pose.time_s = static_cast<double>(frame) / 1000.0;
  pose.centre.x_px = 40.0 + 3.6 * f;
  pose.centre.y_px =
      RampAt(pose.centre.x_px) - kHalfShort_px / std::cos(kInclined_rad);
  pose.angle_rad = kInclined_rad + film.turn_rad * f;
  return pose;
}

// Dark ends, between them a bar with a bright strip, as bright as the wall
// otherwise.
double BodyOver(const Film& film, double u, double v, double behind_dn) {
  const double bar =
      Edge(kHalfLong_px - std::abs(u)) * Edge(kHalfShort_px - std::abs(v));
  const double end = film.parts ? Edge(std::abs(u) - 12.0) : 1.0;
  const double strip = Edge(1.5 - std::abs(v + 3.0)) * (1.0 - end);
  const double level = 158.0 + end * (40.0 - 158.0) + strip * 60.0;
  return behind_dn + bar * (level - behind_dn);
}

void DrawFrame(const Film& film, std::uint64_t seed, std::int64_t index,
               std::vector<double>& levels) {
  std::mt19937_64 engine(seed + static_cast<std::uint64_t>(index));
  std::normal_distribution<double> noise(0.0, kNoise_dn);
  const Pose pose = TrueAt(film, index);
  const double cosine = std::cos(pose.angle_rad);
  const double sine = std::sin(pose.angle_rad);
  for (int y = 0; y < kHeight_px; ++y) {
    for (int x = 0; x < kWidth_px; ++x) {
      const double dx = x - pose.centre.x_px;
      const double dy = y - pose.centre.y_px;
      const double u = dx * cosine + dy * sine;
      const double v = dy * cosine - dx * sine;
      double level = BodyOver(film, u, v, BackgroundAt(x, y));
      if (film.reflects) {
        level = BodyOver(film, u, 2.0 * kHalfShort_px - v, level);
      }
      level += noise(engine);
      levels.push_back(level);
    }
  }
}

class Drawn : public synthetic::DrawnClip {
 public:
  Drawn(const Film& film, std::uint64_t seed)
      : DrawnClip(
            kWidth_px, kHeight_px, kFrames, 1000.0,
            [film, seed](std::int64_t frame, std::vector<double>& levels) {
              DrawFrame(film, seed, frame, levels);
            }) {}
};

Background Noise() {
  Background background;
  background.width_px = kWidth_px;
  background.height_px = kHeight_px;
  background.level.assign(static_cast<std::size_t>(kWidth_px) * kHeight_px,
                          150.0F);
  background.noise_floor_dn2 = kNoise_dn * kNoise_dn;
  return background;
}

// The followed end: its outlines wander.
Track EndOf(const Film& film) {
  Track track;
  track.body.kind = core::BodyKind::kRectangle;
  track.body.half_long_px = {8.0, 0.2, std::nullopt};
  track.body.half_short_px = {6.0, 0.2, std::nullopt};
  track.body.blur_px = 0.8;
  track.body.contrast_dn = -110.0;
  track.first_frame = 0;
  track.last_frame = kFrames;
  track.frame_interval_s = 1e-3;
  track.known_background = false;
  std::mt19937_64 engine(5);
  std::normal_distribution<double> noise(0.0, 0.4);
  for (std::int64_t f = 0; f < kFrames; ++f) {
    Pose pose = TrueAt(film, f);
    pose.centre.x_px +=
        film.end_x_px * std::cos(pose.angle_rad) + noise(engine);
    pose.centre.y_px +=
        film.end_x_px * std::sin(pose.angle_rad) + noise(engine);
    pose.misfit = 5.0;
    track.poses.push_back(pose);
  }
  return track;
}

void ExpectWhole(const std::optional<Track>& whole, const Film& film) {
  ASSERT_TRUE(whole);
  EXPECT_FALSE(whole->outlined);
  ASSERT_EQ(whole->body.kind, core::BodyKind::kRectangle);
  EXPECT_NEAR(whole->body.half_long_px.value, kHalfLong_px, 1.0);
  EXPECT_NEAR(whole->body.half_short_px.value, kHalfShort_px, 1.0);
  ASSERT_EQ(whole->poses.size(), static_cast<std::size_t>(kFrames));
  double x = 0.0;
  double y = 0.0;
  for (const Pose& pose : whole->poses) {
    const Pose truth = TrueAt(film, pose.frame);
    x += (pose.centre.x_px - truth.centre.x_px) / kFrames;
    y += (pose.centre.y_px - truth.centre.y_px) / kFrames;
    EXPECT_NEAR(pose.angle_rad, truth.angle_rad, 0.03) << pose.frame;
  }
  EXPECT_NEAR(x, 0.0, 1.0);
  EXPECT_NEAR(y, 0.0, 1.0);
}

TEST(FindWhole, AnEndLeadsToTheBlock) {
  const Film film;
  Drawn clip(film, 1);
  ExpectWhole(FindWhole(clip, Noise(), EndOf(film), {}), film);
}

// Places that it covers in most frames are known from the few others.
TEST(FindWhole, AlsoWhereItStaysLong) {
  Film film;
  film.stay = 26;
  Drawn clip(film, 2);
  ExpectWhole(FindWhole(clip, Noise(), EndOf(film), {}), film);
}

TEST(FindWhole, AlsoOfOneThatTurns) {
  Film film;
  film.turn_rad = 0.02;
  Drawn clip(film, 3);
  ExpectWhole(FindWhole(clip, Noise(), EndOf(film), {}), film);
}

TEST(FindWhole, WhatTheGroundReflectsIsNoneOfIt) {
  Film film;
  film.reflects = true;
  Drawn clip(film, 4);
  TrackOptions options;
  options.ground =
      calib::MakeGroundLine({0.0, RampAt(0.0)}, {kWidth_px, RampAt(kWidth_px)});
  ExpectWhole(FindWhole(clip, Noise(), EndOf(film), options), film);
}

// Blobs are good to a pixel or two.
TEST(FindWhole, APathOfBlobsWillDo) {
  const Film film;
  Drawn clip(film, 5);
  const Track end = EndOf(film);
  Chain chain;
  for (const Pose& pose : end.poses) {
    Link link;
    link.frame = pose.frame;
    link.time_s = pose.time_s;
    link.blob.centre = pose.centre;
    link.blob.area_px2 = 190.0;
    chain.links.push_back(link);
  }
  const Track path = MakePath(chain, end);
  EXPECT_EQ(path.poses.size(), end.poses.size());
  EXPECT_EQ(path.poses.front().misfit, 5.0);
  ExpectWhole(FindWhole(clip, Noise(), path, {}), film);
}

TEST(FindWhole, ABodyOfOnePartIsItsOwnWhole) {
  Film film;
  film.parts = false;
  film.end_x_px = 0.0;
  Drawn clip(film, 6);
  Track track = EndOf(film);
  track.body.half_long_px.value = kHalfLong_px;
  track.body.half_short_px.value = kHalfShort_px;
  EXPECT_FALSE(FindWhole(clip, Noise(), track, {}));
}

TEST(FindWhole, DoesNotDependOnThreads) {
  const Film film;
  Drawn clip(film, 7);
  TrackOptions options;
  options.threads = 1;
  const auto one = FindWhole(clip, Noise(), EndOf(film), options);
  options.threads = 4;
  const auto four = FindWhole(clip, Noise(), EndOf(film), options);
  ASSERT_TRUE(one);
  ASSERT_TRUE(four);
  EXPECT_EQ(one->body.half_long_px.value, four->body.half_long_px.value);
  EXPECT_EQ(one->poses[3].centre.x_px, four->poses[3].centre.x_px);
}

}  // namespace
}  // namespace touchdown::vision
