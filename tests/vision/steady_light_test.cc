#include "touchdown/vision/background/steady_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>

#include "tests/pipeline/filmed.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::vision {
namespace {

using pipeline::filmed::Default;
using pipeline::filmed::Film;

std::unique_ptr<Clip> Open(const Film& film) {
  return OpenScene(pipeline::filmed::BuildScene(film), 1);
}

Film Flickering(double amplitude, std::int32_t bit_depth) {
  Film film = Default(core::BodyKind::kSphere);
  film.camera.bit_depth = bit_depth;
  film.trouble.flicker_amplitude = amplitude;
  film.trouble.flicker_hz = film.camera.fps / 17.3;
  return film;
}

// Mean of a corner that the body never reaches, in units of full scale.
double Corner(Clip& clip, std::int64_t index) {
  const core::Frame frame = clip.Read(index, {4, 4, 20, 12});
  double sum = 0.0;
  for (std::int32_t y = 0; y < frame.height_px; ++y) {
    for (std::int32_t x = 0; x < frame.width_px; ++x) sum += frame.at(x, y);
  }
  return sum / (frame.width_px * frame.height_px) /
         ((1 << clip.info().bit_depth) - 1);
}

double SpreadOfCorner(Clip& clip) {
  const std::int64_t n = clip.info().frames;
  double mean = 0.0;
  for (std::int64_t i = 0; i < n; ++i)
    mean += Corner(clip, i) / static_cast<double>(n);
  double square = 0.0;
  for (std::int64_t i = 0; i < n; ++i) {
    const double off = Corner(clip, i) / mean - 1.0;
    square += off * off / static_cast<double>(n);
  }
  return std::sqrt(square);
}

// A sine's standard deviation is its amplitude over sqrt(2).
TEST(SteadyLight, FlickerIsTakenOut) {
  for (const std::int32_t bits : {8, 12}) {
    for (const double amplitude : {0.03, 0.1, 0.3}) {
      SCOPED_TRACE(amplitude);
      const Film film = Flickering(amplitude, bits);
      auto raw = Open(film);
      EXPECT_NEAR(SpreadOfCorner(*raw), amplitude / std::sqrt(2.0),
                  0.1 * amplitude);
      const SteadyLight light = Deflicker(Open(film), 0, film.frames);
      EXPECT_TRUE(light.corrected);
      EXPECT_NEAR(light.spread, amplitude / std::sqrt(2.0), 0.1 * amplitude);
      EXPECT_EQ(light.clip->info().bit_depth, 16);
      // The corner's own noise, and half a per cent of the flicker.
      const double noise =
          film.noise / film.look.background_level / std::sqrt(240.0);
      EXPECT_LT(SpreadOfCorner(*light.clip), 1.3 * noise + 0.005 * amplitude);
    }
  }
}

// The clip that was given comes back where the light is steady, noise or not,
// and whatever moves.
TEST(SteadyLight, SteadyLightIsLeftAlone) {
  for (const double noise : {0.0, 0.006, 0.03}) {
    Film film = Default(core::BodyKind::kRectangle);
    film.noise = noise;
    auto clip = Open(film);
    const Clip* const given = clip.get();
    const SteadyLight light = Deflicker(std::move(clip), 0, film.frames);
    EXPECT_FALSE(light.corrected) << light.spread;
    EXPECT_EQ(light.clip.get(), given);
  }
}

// A dark body that hides a quarter of the picture in half of the frames looked
// at: least squares of all points would take it for less light.
Film FilledByTheBody() {
  Film film = Default(core::BodyKind::kSphere);
  film.camera.height_px = 180;
  film.camera.ground_point.y_px = 156.0;
  film.thrown.half_long_m = film.thrown.half_short_m = 0.06;
  film.look.background_level = 0.7;
  film.look.body_level = 0.2;
  return film;
}
constexpr std::int64_t kBeforeIt = 35;  // of the body's first frame, 50

TEST(SteadyLight, ALargeBodyIsNoFlicker) {
  const Film film = FilledByTheBody();
  const SteadyLight light = Deflicker(Open(film), kBeforeIt, film.frames);
  EXPECT_TRUE(light.told);
  EXPECT_FALSE(light.corrected) << light.spread;
  EXPECT_LT(light.spread, 0.5 * SteadyLightOptions{}.least_spread);
}

TEST(SteadyLight, FlickerBesideALargeBodyIsTakenOut) {
  constexpr double kAmplitude = 0.1;
  Film film = FilledByTheBody();
  film.trouble.flicker_amplitude = kAmplitude;
  film.trouble.flicker_hz = film.camera.fps / 17.3;
  const SteadyLight light = Deflicker(Open(film), kBeforeIt, film.frames);
  ASSERT_TRUE(light.corrected);
  // What is left: where the body passes, the median over the frames is of
  // those without it, which have a light of their own.
  EXPECT_LT(SpreadOfCorner(*light.clip), 0.07 * kAmplitude);
}

TEST(SteadyLight, FullScaleStaysFullScale) {
  Film film = Flickering(0.1, 8);
  film.look.background_level = 1.0;  // clipped half of the time
  film.noise = 0.0;
  const SteadyLight light = Deflicker(Open(film), 0, film.frames);
  ASSERT_TRUE(light.corrected);
  auto raw = Open(film);
  for (std::int64_t i = 0; i < film.frames; i += 5) {
    for (std::int32_t x = 0; x < 240; x += 7) {
      if (raw->Read(i).at(x, 3) == 255) {
        EXPECT_EQ(light.clip->Read(i).at(x, 3), 65535);
      }
    }
  }
}

// What is left of a picture at full scale is the body, whose motion is no
// flicker.
TEST(SteadyLight, CannotBeToldBehindABacklitBody) {
  for (const std::int64_t frames : {6, 15, 40}) {
    Film film = Default(core::BodyKind::kSphere);
    film.look.background_level = film.look.ground_level = 1.0;
    film.look.gradient_x = film.look.gradient_y = 0.0;
    film.noise = 0.0;
    const SteadyLight light = Deflicker(Open(film), 0, frames);
    EXPECT_FALSE(light.told);
    EXPECT_FALSE(light.corrected) << light.spread;
  }
}

TEST(SteadyLight, WindowsAreCrops) {
  const Film film = Flickering(0.1, 8);
  const SteadyLight light = Deflicker(Open(film), 0, film.frames);
  const core::Frame whole = light.clip->Read(60);
  const auto level = whole.at(33, 27);
  const core::Frame window = light.clip->Read(60, {30, 20, 10, 10});
  EXPECT_EQ(window.at(3, 7), level);
  EXPECT_EQ(window.origin_x_px, 30);
}

TEST(SteadyLight, RangeIsChecked) {
  const Film film = Flickering(0.1, 8);
  EXPECT_THROW(Deflicker(Open(film), 0, film.frames + 1),
               std::invalid_argument);
  EXPECT_THROW(Deflicker(Open(film), 5, 5), std::invalid_argument);
}

}  // namespace
}  // namespace touchdown::vision
