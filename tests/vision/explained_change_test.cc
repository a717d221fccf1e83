#include "touchdown/vision/explanation/explained_change.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/vision/drawn_clip.h"

namespace touchdown::vision {
namespace {

constexpr std::int32_t kWidth_px = 240;
constexpr std::int32_t kHeight_px = 120;
constexpr std::int32_t kDarkFrom_px = 105;
constexpr std::int64_t kFrames = 60;
constexpr double kBlur_px = 0.9;
constexpr double kHalfLong_px = 16.0;
constexpr double kHalfShort_px = 9.0;

double Edge(double depth_px) {
  return 0.5 * std::erfc(-depth_px / kBlur_px / std::sqrt(2.0));
}

// A textured block crosses a picture of stripes, turning.
struct Film {
  double noise_dn = 2.0;
  double contrast_dn = -70.0;
  double texture_dn = 8.0;
  double shadow_dn = 0.0;   // depth of a soft shadow that moves with the body
  double flicker = 0.0;     // of all light, relative amplitude
  double dark_noise = 1.0;  // times the noise, in a dark strip at the bottom
  bool is_ball = false;     // as wide as the block's short side
  double hole_px = 0.0;     // radius of a hole in the body's middle
  std::int64_t enters = 0;  // frame from which the body is in the picture
  std::uint64_t seed = 1;
};

Pose TrueAt(std::int64_t frame) {
  const auto f = static_cast<double>(frame);
  Pose pose;
  pose.frame = frame;
  pose.time_s = f / 1000.0;
  pose.centre = {30.0 + 3.0 * f, 40.0 + 0.8 * f - 0.004 * f * f};
  pose.angle_rad = 0.2 + 0.01 * f;
  return pose;
}

double StillAt(double x, double y) {
  return 150.0 + 12.0 * std::sin(0.11 * x) + 9.0 * std::cos(0.17 * y);
}

void DrawFrame(const Film& film, std::int64_t index,
               std::vector<double>& levels) {
  std::mt19937_64 engine(1000 * film.seed + static_cast<std::uint64_t>(index));
  std::normal_distribution<double> noise(0.0, film.noise_dn);
  const Pose pose = TrueAt(index);
  const double cosine = std::cos(pose.angle_rad);
  const double sine = std::sin(pose.angle_rad);
  const double light =
      1.0 + film.flicker * std::sin(1.7 * static_cast<double>(index));
  for (std::int32_t y = 0; y < kHeight_px; ++y) {
    for (std::int32_t x = 0; x < kWidth_px; ++x) {
      double level = StillAt(x, y);
      if (index >= film.enters) {
        const double dx = x - pose.centre.x_px;
        const double dy = y - pose.centre.y_px;
        const double u = cosine * dx + sine * dy;
        const double v = cosine * dy - sine * dx;
        const double below = (dy - 16.0) / 8.0;
        const double aside = dx / 20.0;
        level -=
            film.shadow_dn * std::exp(-0.5 * (below * below + aside * aside));
        const double cover = film.is_ball
                                 ? Edge(kHalfShort_px - std::hypot(u, v))
                                 : Edge(kHalfLong_px - std::abs(u)) *
                                       Edge(kHalfShort_px - std::abs(v));
        const double face =
            150.0 + film.contrast_dn +
            film.texture_dn * std::sin(0.8 * u) * std::cos(0.9 * v);
        const double whole = Edge(std::hypot(u, v) - film.hole_px);
        level += cover * (film.hole_px > 0.0 ? whole : 1.0) * (face - level);
      }
      if (film.dark_noise != 1.0 && y >= kDarkFrom_px) {
        levels.push_back(30.0 + film.dark_noise * noise(engine));
        continue;
      }
      levels.push_back(light * level + noise(engine));
    }
  }
}

synthetic::DrawnClip ClipOf(const Film& film) {
  return {kWidth_px, kHeight_px, kFrames, 1000.0,
          [film](std::int64_t index, std::vector<double>& levels) {
            DrawFrame(film, index, levels);
          }};
}

Track TrueTrack(const Film& film = {}) {
  Track track;
  track.body.kind = core::BodyKind::kRectangle;
  track.body.half_long_px = {kHalfLong_px, 0.01, std::nullopt};
  track.body.half_short_px = {kHalfShort_px, 0.01, std::nullopt};
  track.body.blur_px = kBlur_px;
  track.body.contrast_dn = film.contrast_dn;
  track.last_frame = kFrames;
  track.frame_interval_s = 1e-3;
  for (std::int64_t f = film.enters; f < kFrames; ++f) {
    track.poses.push_back(TrueAt(f));
  }
  return track;
}

ExplainedChange Measured(const Film& film, const Track& track) {
  synthetic::DrawnClip clip = ClipOf(film);
  const auto explained = MeasureExplainedChange(clip, track);
  EXPECT_TRUE(explained) << explained.error().reason;
  return explained.value_or(ExplainedChange{});
}

TEST(ExplainedChange, TruePosesExplainAll) {
  const Film film;
  const ExplainedChange explained = Measured(film, TrueTrack());
  EXPECT_GT(explained.near, 0.98);
  EXPECT_LT(explained.near, 1.01);
  EXPECT_LT(explained.elsewhere, 0.02);
  EXPECT_LT(explained.band_chi2, 4.0);
  EXPECT_NEAR(explained.noise_dn, film.noise_dn, 0.1 * film.noise_dn);
  EXPECT_EQ(explained.lost, 0);
}

// A wobble that no parabola follows costs the edges first.
TEST(ExplainedChange, PosesThatAreOffExplainLess) {
  const Film film;
  const ExplainedChange right = Measured(film, TrueTrack());
  double before = right.near;
  double band_before = right.band_chi2;
  for (const double off_px : {0.5, 1.0, 3.0}) {
    Track track = TrueTrack();
    for (Pose& pose : track.poses) {
      pose.centre.y_px += pose.frame % 2 == 0 ? off_px : -off_px;
    }
    const ExplainedChange off = Measured(film, track);
    EXPECT_LT(off.near, before) << off_px;
    EXPECT_GT(off.band_chi2, 1.5 * band_before) << off_px;
    before = off.near;
    band_before = off.band_chi2;
  }
  EXPECT_GT(before, 0.5);
}

// What lies beside the body by less than blur and a sample's distance may count
// as seen, 2 px in all; what lies within it must.
TEST(ExplainedChange, TellsWhichPartOfTheBodyIsSeen) {
  constexpr double kBeside_px = 2.0;
  for (const double larger : {1.0, 1.4, 1.8}) {
    SCOPED_TRACE(larger);
    Track track = TrueTrack();
    track.body.half_long_px.value *= larger;
    track.body.half_short_px.value *= larger;
    const ExplainedChange explained = Measured({}, track);
    EXPECT_GT(explained.near, 0.9);  // a larger outline explains as much
    ASSERT_TRUE(explained.seen);
    const double area = larger * larger * kHalfLong_px * kHalfShort_px;
    EXPECT_GT(*explained.seen, 0.97 * kHalfLong_px * kHalfShort_px / area);
    EXPECT_LT(*explained.seen, (kHalfLong_px + kBeside_px) *
                                   (kHalfShort_px + kBeside_px) / area);
  }
}

// Within the outline something else may show: a hole of the wheel, a mark that
// has turned away.
TEST(ExplainedChange, AHoleIsNoMissingRim) {
  Film film;
  film.hole_px = 4.0;
  const ExplainedChange explained = Measured(film, TrueTrack());
  ASSERT_TRUE(explained.seen);
  EXPECT_EQ(*explained.seen, 1.0);
}

TEST(ExplainedChange, ADiscExplainsABallAsWellAsASquareDoes) {
  for (const bool is_ball : {true, false}) {
    SCOPED_TRACE(is_ball);
    Film film;
    film.is_ball = is_ball;
    Track track = TrueTrack();
    if (is_ball) track.body.half_long_px = track.body.half_short_px;
    const ExplainedChange explained = Measured(film, track);
    EXPECT_GT(explained.near, 0.95);
    ASSERT_TRUE(explained.near_as_disc);
    if (is_ball) {
      EXPECT_GT(*explained.near_as_disc, explained.near - 0.01);
    } else {
      EXPECT_LT(*explained.near_as_disc, explained.near - 0.3);
    }
    track.body.kind = core::BodyKind::kSphere;
    track.body.radius_px = track.body.half_short_px;
    EXPECT_FALSE(Measured(film, track).near_as_disc);
  }
}

// What stands still, somewhere on the body's way, explains nothing.
TEST(ExplainedChange, GhostExplainsNothing) {
  Track track = TrueTrack();
  for (Pose& pose : track.poses) {
    const auto frame = pose.frame;
    pose = TrueAt(kFrames / 2);
    pose.frame = frame;
    // It jitters, as fits to a ghost's edges do.
    pose.centre.x_px += frame % 2 == 0 ? 1.5 : -1.5;
  }
  EXPECT_LT(Measured({}, track).near, 0.02);
}

// Beside the body: the still picture is learned with the body in it.
TEST(ExplainedChange, WrongPlaceExplainsHardlyAnything) {
  Track track = TrueTrack();
  for (Pose& pose : track.poses) pose.centre.y_px += 2.0 * kHalfShort_px;
  EXPECT_LT(Measured({}, track).near, 0.2);
}

TEST(ExplainedChange, LostFramesAreUnexplained) {
  Track track = TrueTrack();
  std::erase_if(track.poses, [](const Pose& pose) {
    return pose.frame >= 20 && pose.frame < 40;
  });
  const ExplainedChange explained = Measured({}, track);
  // A third of the frames.
  EXPECT_LT(explained.near, 0.8);
  EXPECT_GT(explained.near, 0.5);
  EXPECT_GE(explained.lost, explained.frames / 4);
}

// Frames before the body is in the picture do not count against it.
TEST(ExplainedChange, EmptyFramesAreExplained) {
  Film film;
  film.enters = 25;
  const ExplainedChange explained = Measured(film, TrueTrack(film));
  EXPECT_GT(explained.near, 0.98);
  EXPECT_EQ(explained.lost, 0);
}

// The terms of the noise cancel: over seeds the mean stays where it is.
TEST(ExplainedChange, NoiseDoesNotMoveIt) {
  constexpr int kSeeds = 6;
  for (const double noise_dn : {1.0, 4.0, 12.0}) {
    double sum = 0.0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      Film film;
      film.noise_dn = noise_dn;
      film.seed = static_cast<std::uint64_t>(seed);
      sum += Measured(film, TrueTrack()).near / kSeeds;
    }
    // 0.994, 0.995, 1.010: at 12 DN the noise itself is known to 1 %.
    EXPECT_NEAR(sum, 1.0, 0.02) << noise_dn;
  }
}

// A camera with a gamma has most noise in the dark: it is no change.
TEST(ExplainedChange, NoiseOfTheDarkIsNoChange) {
  Film film;
  film.contrast_dn = -20.0;
  film.dark_noise = 4.0;
  const ExplainedChange explained = Measured(film, TrueTrack(film));
  EXPECT_GT(explained.near, 0.95);
  EXPECT_LT(explained.elsewhere, 0.02);
}

TEST(ExplainedChange, SoftShadowAndFlickerLeaveItHigh) {
  Film film;
  film.shadow_dn = 30.0;
  EXPECT_GT(Measured(film, TrueTrack()).near, 0.7);
  film.shadow_dn = 0.0;
  film.flicker = 0.01;  // what Deflicker leaves at most
  EXPECT_GT(Measured(film, TrueTrack()).near, 0.9);
}

// A place on the wall that was followed instead of the body: composite 65_7 was
// "on the ground from the start, stays where it touched down".
TEST(ExplainedChange, NothingIsExplainedWithoutChange) {
  Film film;
  film.contrast_dn = 0.0;
  film.texture_dn = 0.0;
  film.noise_dn = 30.0;
  film.enters = kFrames;  // never
  synthetic::DrawnClip clip = ClipOf(film);
  const auto none = MeasureExplainedChange(clip, TrueTrack());
  ASSERT_TRUE(none);
  EXPECT_EQ(none->near, 0.0);
  EXPECT_FALSE(none->seen);
  Track few = TrueTrack();
  few.poses.resize(2);
  EXPECT_FALSE(MeasureExplainedChange(clip, few));
}

TEST(ExplainedChange, RefusesImpossibleOptions) {
  synthetic::DrawnClip clip = ClipOf({});
  ExplainedChangeOptions options;
  options.frames = 2;
  EXPECT_THROW(MeasureExplainedChange(clip, TrueTrack(), options),
               std::invalid_argument);
  Track longer = TrueTrack();
  longer.last_frame = kFrames + 1;
  EXPECT_THROW(MeasureExplainedChange(clip, longer), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::vision
