#include "touchdown/vision/background/background.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "tests/support/statistics.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::vision {
namespace {

using touchdown::testing::Rms;

struct MovingOptions {
  std::int64_t frames = 60;
  std::int32_t bit_depth = 8;
  double speed_px = 4.0;  // a frame
  double read_dn = 2.0;
  double shot = 0.0;
  double background_level = 0.65;
};

// A disc of 10 px that crosses the picture.
Scene Moving(const MovingOptions& options) {
  Scene scene;
  scene.camera.width_px = 160;
  scene.camera.height_px = 80;
  scene.camera.px_per_m = 1000.0;
  scene.camera.ground_point = {0.0, 60.0};
  scene.camera.fps = 1000.0;
  scene.camera.bit_depth = options.bit_depth;
  scene.look.gradient_x = 0.1;
  scene.look.background_level = options.background_level;
  scene.body = core::Sphere({0.02, 0.0});
  scene.frames = options.frames;
  scene.noise = {options.read_dn, options.shot};
  const double speed = options.speed_px;
  scene.pose = [speed](double t) {
    return ScenePose{{-0.03 + speed * t, 0.025}, 0.0};
  };
  return scene;
}

std::vector<double> Errors(const Background& background,
                           const SceneRenderer& truth) {
  std::vector<double> errors;
  for (int y = 0; y < background.height_px; ++y) {
    for (int x = 0; x < background.width_px; ++x) {
      if (!background.known_at(x, y)) continue;
      errors.push_back(static_cast<double>(background.at(x, y)) -
                       static_cast<double>(truth.background().at(x, y)));
    }
  }
  return errors;
}

// The mid-mean of 33 samples of noise 2 has 1.2 times the variance of a mean.
TEST(Background, IsWhatIsThereWithoutTheBody) {
  const Scene scene = Moving({});
  const SceneRenderer truth(scene);
  const auto clip = OpenScene(scene, 1);
  const Background background = EstimateBackground(*clip, 0, 60);
  EXPECT_EQ(background.width_px, 160);
  EXPECT_EQ(background.height_px, 80);
  EXPECT_EQ(background.full_scale_dn, 255.0);
  EXPECT_TRUE(background.known_at(3, 4));
  const double expected = std::sqrt((4.0 + 1.0 / 12.0) * 1.2 / 33.0);
  const auto errors = Errors(background, truth);
  // Where the body passes a few samples are gone and the middle half shifts a
  // little: 30 % above what an empty picture gives, over all.
  EXPECT_LT(Rms(errors), 1.3 * expected);
  EXPECT_GT(Rms(errors), 0.85 * expected);
  for (const double e : errors) ASSERT_LT(std::abs(e), 8.0 * expected);
}

TEST(Background, NoiseOfTheClipItself) {
  for (const double read : {0.3, 1.0, 3.0, 8.0}) {
    MovingOptions options;
    options.read_dn = read;
    const auto clip = OpenScene(Moving(options), 2);
    const Background background = EstimateBackground(*clip, 0, 60);
    const double sigma = std::sqrt(read * read + 1.0 / 12.0);
    for (const double level : {100.0, 160.0}) {
      // Noise of a third of a DN, or of one, is no longer normal once it is
      // rounded: the middle 80 % of whole differences tell it to 20 or 10 %.
      EXPECT_NEAR(std::sqrt(background.Variance(level)) / sigma, 1.0,
                  read < 0.5   ? 0.2
                  : read < 2.0 ? 0.1
                               : 0.06)
          << read << " at " << level;
    }
  }
}

TEST(Background, ShotNoiseGrowsWithTheLevel) {
  MovingOptions options;
  options.bit_depth = 12;
  options.read_dn = 5.0;
  options.shot = 0.5;
  const auto clip = OpenScene(Moving(options), 3);
  const Background background = EstimateBackground(*clip, 0, 60);
  // Ground and what is behind: 0.40 and 0.65 of 4095.
  for (const double level : {0.40 * 4095, 0.65 * 4095}) {
    EXPECT_NEAR(background.Variance(level) / (25.0 + 0.5 * level), 1.0, 0.08)
        << level;
  }
}

// As the same frames show it in light: levels within what rounding and the
// curve of a mean make of them.
TEST(Background, InLightIsThatOfTheLight) {
  const auto clip = OpenScene(Moving({}), 6);
  const LightScale scale = MakeLightScale(clip->info().bit_depth, 0.45);
  const auto view = ViewInLight(*clip, scale.gamma);
  const std::int64_t frames = clip->info().frames;
  const Background light = InLight(EstimateBackground(*clip, 0, frames), scale);
  const Background seen = EstimateBackground(*view, 0, frames);
  EXPECT_EQ(light.full_scale_dn, seen.full_scale_dn);
  for (std::size_t i = 0; i < seen.level.size(); i += 97) {
    EXPECT_NEAR(light.level[i], seen.level[i], 0.01 * seen.level[i]) << i;
  }
  EXPECT_NEAR(std::sqrt(light.UsualVariance()), std::sqrt(seen.UsualVariance()),
              0.1 * std::sqrt(seen.UsualVariance()));
}

TEST(Background, VarianceIsNeverLessThanRounding) {
  Background background;
  background.noise_floor_dn2 = 0.0;
  EXPECT_DOUBLE_EQ(background.Variance(0.0), 1.0 / 12.0);
  MovingOptions options;
  options.read_dn = 0.0;  // a noiseless clip
  const auto clip = OpenScene(Moving(options), 3);
  const Background measured = EstimateBackground(*clip, 0, 60);
  EXPECT_GE(measured.Variance(160.0), 1.0 / 12.0);
  EXPECT_LT(measured.Variance(160.0), 0.5);
}

TEST(Background, SaturatedSamplesTellNoNoise) {
  MovingOptions options;
  options.background_level = 1.0;
  options.read_dn = 3.0;
  const auto clip = OpenScene(Moving(options), 4);
  const Background background = EstimateBackground(*clip, 0, 60);
  // What the ground, which is not saturated, shows.
  EXPECT_NEAR(std::sqrt(background.Variance(102.0)), 3.0, 0.4);
  EXPECT_TRUE(std::isfinite(background.Variance(255.0)));
}

// A body that covers pixels most of the time leaves a ghost; where its place is
// known it does not, and what it never leaves is not known.
TEST(Background, BehindASlowBody) {
  MovingOptions options;
  options.speed_px = 0.4;  // 24 px in the clip: it covers its middle always
  Scene scene = Moving(options);
  scene.pose = [](double t) { return ScenePose{{0.06 + 0.4 * t, 0.025}, 0.0}; };
  const SceneRenderer truth(scene);
  const auto clip = OpenScene(scene, 5);
  const Background ghost = EstimateBackground(*clip, 0, 60);
  double worst = 0.0;
  for (const double e : Errors(ghost, truth)) {
    worst = std::max(worst, std::abs(e));
  }
  EXPECT_GT(worst, 60.0);  // the ghost

  int asked = 0;
  const Covers covers = FindCovers(0, 60, [&](std::int64_t frame) {
    ++asked;
    Cover cover;
    if (frame == 0) {  // its place is not known here
      cover.known = false;
      return cover;
    }
    const SceneTruth at = ComputeTruth(scene, frame);
    cover.box = {0, 0, 160, 80};
    for (int y = 0; y < 80; ++y) {
      for (int x = 0; x < 160; ++x) {
        cover.mask.push_back(
            std::hypot(x - at.centre.x_px, y - at.centre.y_px) < 14.0);
      }
    }
    return cover;
  });
  EXPECT_EQ(asked, 33);
  EXPECT_EQ(covers.frames.size(), 32U);
  EXPECT_DOUBLE_EQ(covers.most, 1.0);
  const Background behind = EstimateMaskedBackground(*clip, covers, ghost);
  EXPECT_FALSE(behind.known_at(72, 35));
  EXPECT_TRUE(behind.known_at(40, 35));
  EXPECT_TRUE(behind.known_at(110, 35));
  for (const double e : Errors(behind, truth)) {
    ASSERT_LT(std::abs(e), 6.0);  // 3 samples of noise 2 at the least
  }
}

TEST(Background, RangesOutsideTheClipAreRefused) {
  const auto clip = OpenScene(Moving({}), 1);
  for (const auto& [first, last] :
       std::vector<std::pair<int, int>>{{-1, 5}, {5, 5}, {6, 5}, {0, 61}}) {
    try {
      EstimateBackground(*clip, first, last);
      ADD_FAILURE() << first << ":" << last;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr("frames"));
      EXPECT_THAT(error.what(), ::testing::HasSubstr("0:60"));
    }
  }
}

TEST(Background, SamplesAreTakenAmongTheFramesAtHand) {
  BackgroundOptions options;
  options.samples = 4;
  EXPECT_EQ(BackgroundFrames(0, 60, options), BackgroundFrames(0, 60, 4));
  for (std::int64_t frame = 3; frame < 60; frame += 5) {
    options.among.push_back(frame);
  }
  EXPECT_EQ(BackgroundFrames(0, 60, options),
            (std::vector<std::int64_t>{3, 18, 43, 58}));
  EXPECT_EQ(BackgroundFrames(10, 24, options),
            (std::vector<std::int64_t>{13, 18, 23}));
  // None of them is in the range: any of it.
  EXPECT_EQ(BackgroundFrames(4, 7, options),
            (std::vector<std::int64_t>{4, 5, 6}));
  options.among = {7};
  const auto clip = OpenScene(Moving({}), 1);
  EXPECT_EQ(EstimateBackground(*clip, 0, 60, options).at(5, 5),
            static_cast<float>(clip->Read(7).at(5, 5)));
}

TEST(Background, OneFrameIsABackgroundToo) {
  const auto clip = OpenScene(Moving({}), 1);
  const Background background = EstimateBackground(*clip, 7, 8);
  EXPECT_EQ(background.at(5, 5), static_cast<float>(clip->Read(7).at(5, 5)));
  EXPECT_GT(background.Variance(100.0), 0.0);
}

}  // namespace
}  // namespace touchdown::vision
