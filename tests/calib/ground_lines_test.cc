#include "touchdown/calib/ground_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "tests/support/statistics.h"
#include "touchdown/calib/plane.h"
#include "touchdown/core/units.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::calib {
namespace {

using namespace core::literals;  // NOLINT
using touchdown::testing::Largest;
using touchdown::testing::Rms;
using touchdown::testing::RmsBand9999;

// The picture of a still ground: a scene whose body is far out of sight.
struct Still {
  vision::SceneCamera camera;
  vision::CleanImage image;
  double noise_dn = 0.0;

  StillImage view() const {
    return {image.dn.data(), image.width_px, image.height_px, noise_dn};
  }
};

struct StillOptions {
  double roll_rad = 0.0;
  double noise_dn = 2.0;
  double texture = 0.0;
  double gradient = 0.0;
  double ground_level = 0.40;
  double wave_px = 0.0;
  double wave_length_px = 40.0;
  int most_lines = 4;  // to be found
};

Still Picture(std::uint64_t seed, const StillOptions& options) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> within(-0.5, 0.5);
  vision::Scene scene;
  scene.body = core::Sphere({0.01, 0.0});
  scene.pose = [](double) { return vision::ScenePose{{1e3, 1e3}, 0.0}; };
  scene.camera.width_px = 320;
  scene.camera.height_px = 160;
  scene.camera.ground_point = {160.0, 100.0 + within(engine)};
  scene.camera.roll_rad = options.roll_rad + 0.01 * within(engine);
  scene.look.ground_level = options.ground_level;
  scene.look.gradient_x = options.gradient;
  scene.look.gradient_y = -options.gradient;
  scene.look.texture_amplitude = options.texture;
  scene.look.texture_seed = seed;
  scene.trouble.wave_amplitude_px = options.wave_px;
  scene.trouble.wave_length_px = options.wave_length_px;
  Still still;
  still.camera = scene.camera;
  still.image = vision::SceneRenderer(scene).background();
  still.noise_dn = options.noise_dn;
  vision::AddSensorNoise(still.image, {options.noise_dn, 0.0}, engine);
  return still;
}

// Errors of the first line found over its stated uncertainty: of direction, and
// of height at the line's own reference point.
struct Errors {
  std::vector<double> z_angle;
  std::vector<double> z_height;
  std::vector<double> angle_rad;
  std::vector<double> height_px;
};

Errors Measure(const StillOptions& options, int seeds) {
  Errors errors;
  GroundLineOptions find;
  find.most_lines = options.most_lines;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Still still = Picture(static_cast<std::uint64_t>(seed), options);
    const std::vector<GroundLine> lines = FindGroundLines(still.view(), find);
    if (lines.size() != 1) {
      ADD_FAILURE() << lines.size() << " lines with seed " << seed;
      continue;
    }
    const GroundLine truth = vision::TrueGroundLine(still.camera);
    const GroundLine& line = lines.front();
    EXPECT_EQ(line.source, GroundSource::kDetected);
    EXPECT_GT(line.u_offset_px, 0.0);
    EXPECT_GT(line.u_angle_rad, 0.0);
    EXPECT_NEAR(HeightAboveLine(line, line.reference), 0.0, 1e-9);
    const double angle = ImageAngle(line) - ImageAngle(truth);
    errors.angle_rad.push_back(angle);
    errors.z_angle.push_back(angle / line.u_angle_rad);
    errors.height_px.push_back(HeightAboveLine(truth, line.reference));
    errors.z_height.push_back(errors.height_px.back() / line.u_offset_px);
  }
  return errors;
}

constexpr int kSeeds = 60;

void ExpectHonest(const Errors& errors) {
  const auto band = RmsBand9999(errors.z_angle.size());
  EXPECT_GT(Rms(errors.z_angle), band.low);
  EXPECT_LT(Rms(errors.z_angle), band.high);
  EXPECT_GT(Rms(errors.z_height), band.low);
  EXPECT_LT(Rms(errors.z_height), band.high);
  EXPECT_LT(Largest(errors.z_angle), 4.0);
  EXPECT_LT(Largest(errors.z_height), 4.0);
}

// An edge that goes up and down evenly is as good as a straight one, whatever
// part of the last wave is seen.
TEST(GroundLines, EvenWavesAreTakenOut) {
  const Errors straight = Measure({}, kSeeds);
  for (const double length_px : {21.0, 37.0, 75.0}) {
    StillOptions wavy;
    wavy.wave_px = 1.0;
    wavy.wave_length_px = length_px;
    const Errors errors = Measure(wavy, kSeeds);
    const auto band = RmsBand9999(errors.z_angle.size());
    EXPECT_LT(Rms(errors.z_angle), 1.2 * band.high) << length_px;
    EXPECT_LT(Rms(errors.z_height), 1.2 * band.high) << length_px;
    EXPECT_LT(Rms(errors.angle_rad), 2.0 * Rms(straight.angle_rad))
        << length_px;
    EXPECT_LT(Rms(errors.height_px), 2.0 * Rms(straight.height_px))
        << length_px;
  }
}

TEST(GroundLines, LevelGroundUnderNoise) {
  const Errors errors = Measure({}, kSeeds);
  ExpectHonest(errors);
  // A segment of length L with J of edge information: angle sqrt(12/(J L^3))
  // (J = C^2 / (2 sqrt(pi) b s^2); the two levels of each column are free,
  // which costs more than that).
  const double contrast = 0.25 * 255.0;
  const double blur = std::hypot(0.7, std::sqrt(1.0 / 12.0));
  const double j =
      contrast * contrast / (2.0 * std::sqrt(3.141592653589793) * blur * 4.0);
  const double bound = std::sqrt(12.0 / (j * 320.0 * 320.0 * 320.0));
  EXPECT_LT(Rms(errors.angle_rad), 1.5 * bound);
}

TEST(GroundLines, RolledCamera) {
  for (const double roll : {-12.0_deg, -3.0_deg, 5.0_deg, 15.0_deg}) {
    StillOptions options;
    options.roll_rad = roll;
    SCOPED_TRACE(roll / core::kDegree);
    ExpectHonest(Measure(options, kSeeds));
  }
}

TEST(GroundLines, UnevenLight) {
  StillOptions options;
  options.gradient = 0.1;
  ExpectHonest(Measure(options, kSeeds));
}

// A third of the light lost across 160 px: the two levels of a column are no
// longer flat, and the line is off by a hundredth of a pixel, which its u does
// not know (z of 2). Its direction is not touched.
TEST(GroundLines, VeryUnevenLightShiftsByAHundredthOfAPixel) {
  StillOptions options;
  options.gradient = 0.3;
  const Errors errors = Measure(options, kSeeds);
  const auto band = RmsBand9999(errors.z_angle.size());
  EXPECT_LT(Rms(errors.z_angle), band.high);
  EXPECT_LT(Largest(errors.height_px), 0.02);
}

TEST(GroundLines, GroundBrighterThanWhatIsBehind) {
  StillOptions options;
  options.ground_level = 0.9;
  ExpectHonest(Measure(options, kSeeds));
}

TEST(GroundLines, TexturedGround) {
  StillOptions options;
  options.texture = 0.05;
  options.roll_rad = 1.0_deg;
  ExpectHonest(Measure(options, kSeeds));
}

// Where the noise is small beside the texture, the edge's foot tells the
// direction better than equal weights would: as those still tell the height,
// the one measures the other (u_angle = sqrt(12)/L u_height for one weight).
TEST(GroundLines, TheFootOfATexturedEdgeTellsItsDirection) {
  for (const double ground_level : {0.40, 0.9}) {
    StillOptions options;
    options.texture = 0.10;
    options.noise_dn = 0.3;
    options.most_lines = 1;  // a coarse texture has edges of its own
    options.roll_rad = 1.0_deg;
    options.ground_level = ground_level;
    SCOPED_TRACE(ground_level);
    const Errors errors = Measure(options, kSeeds);
    ExpectHonest(errors);
    const double of_equal_weights =
        std::sqrt(12.0) / 320.0 * Rms(errors.height_px);
    EXPECT_LT(Rms(errors.angle_rad), 0.6 * of_equal_weights);
  }
}

TEST(GroundLines, EmptyPictureHasNone) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    StillOptions options;
    options.ground_level = 0.65;  // that of the background
    EXPECT_TRUE(FindGroundLines(Picture(seed, options).view()).empty()) << seed;
  }
}

TEST(GroundLines, WallIsNoGround) {
  // A vertical edge, and a steep one.
  for (const double slope : {0.0, 0.5}) {
    StillImage still{nullptr, 200, 160, 1.0};
    std::vector<float> level;
    for (int y = 0; y < 160; ++y) {
      for (int x = 0; x < 200; ++x) {
        level.push_back(x > 100 + slope * y ? 50.0f : 150.0f);
      }
    }
    still.level = level.data();
    EXPECT_TRUE(FindGroundLines(still).empty()) << slope;
  }
}

TEST(GroundLines, SeveralEdgesAreAllOffered) {
  // A shelf above the ground: both are straight and long, neither is the ground
  // by its look.
  std::mt19937_64 engine(3);
  std::normal_distribution<double> noise(0.0, 1.5);
  std::vector<float> level;
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 240; ++x) {
      const double base = y > 120 ? 60.0 : y > 60 ? 110.0 : 170.0;
      level.push_back(static_cast<float>(base + noise(engine)));
    }
  }
  const auto lines = FindGroundLines({level.data(), 240, 160, 1.5});
  ASSERT_EQ(lines.size(), 2u);
  std::vector<double> heights = {lines[0].reference.y_px,
                                 lines[1].reference.y_px};
  std::sort(heights.begin(), heights.end());
  EXPECT_NEAR(heights[0], 60.5, 0.1);
  EXPECT_NEAR(heights[1], 120.5, 0.1);
}

TEST(GroundLines, TinyPictureIsNoTrouble) {
  for (const std::int32_t side : {1, 4, 9, 15, 16, 17}) {
    const std::vector<float> level(static_cast<std::size_t>(side * side), 7.0f);
    EXPECT_TRUE(FindGroundLines({level.data(), side, side, 1.0}).empty());
  }
}

// A line hidden in part is still a line; one seen in a small part is not.
TEST(GroundLines, PartlyHiddenLine) {
  for (const double shown : {0.5, 0.2}) {
    StillOptions options;
    Still still = Picture(7, options);
    const int from = static_cast<int>(shown * 320);
    for (int y = 0; y < 160; ++y) {
      for (int x = from; x < 320; ++x) {
        still.image.dn[static_cast<std::size_t>(y * 320 + x)] = 40.0f;
      }
    }
    const auto lines = FindGroundLines(still.view());
    EXPECT_EQ(lines.size(), shown > 0.33 ? 1u : 0u) << shown;
    if (!lines.empty()) {
      const GroundLine truth = vision::TrueGroundLine(still.camera);
      EXPECT_NEAR(ImageAngle(lines[0]), ImageAngle(truth),
                  4.0 * lines[0].u_angle_rad);
    }
  }
}

}  // namespace
}  // namespace touchdown::calib
