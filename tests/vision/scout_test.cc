#include "vision/src/detection/scout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "tests/vision/long_clip.h"

namespace touchdown::vision {
namespace {

// A film of 600 frames, a body on its way through it, and what is still.
struct Watched {
  explicit Watched(std::int32_t depth = 8)
      : scene(testing::LongScene(600, depth)),
        clip(OpenScene(scene, 1)),
        still(EstimateBackground(*clip, 0, 600)) {}

  Scene scene;
  std::unique_ptr<Clip> clip;
  Background still;
};

bool Inside(const core::PixelRect& rect, double x, double y) {
  return x >= rect.x && y >= rect.y && x < rect.x + rect.width &&
         y < rect.y + rect.height;
}

TEST(Scout, PointsAtTheBodyAndAtNothingElse) {
  for (const std::int32_t depth : {8, 12}) {
    const Watched watched(depth);
    const auto& [scene, clip, still] = watched;
    const Scout scout(still);
    int regions = 0;
    for (std::int64_t index = 0; index < 600; index += 13) {
      const Changes changes = scout.Look(clip->Read(index));
      EXPECT_LT(changes.noise, 1.3);  // the median of 229 sums: +- 9 %
      regions += static_cast<int>(changes.where.size());
      const SceneTruth truth = ComputeTruth(scene, index);
      const double x = truth.centre.x_px;
      if (x < -11.0 || x > 330.0) continue;
      ASSERT_FALSE(changes.where.empty()) << index;
      // With all of the body, and a margin, as far as it is in the picture.
      const core::PixelRect& found = changes.where.front();
      for (const double dx : {-18.0, 18.0}) {
        EXPECT_TRUE(
            Inside(found, std::clamp(x + dx, 0.0, 319.0), truth.centre.y_px))
            << index;
      }
    }
    // 36 of the 47 looks are at a body; hardly any at noise.
    EXPECT_LE(regions, 38);
  }
}

TEST(Scout, LooksWithinTheRegionOnly) {
  const Watched watched;
  const auto& [scene, clip, still] = watched;
  ScoutOptions options;
  options.region = {0, 0, 100, 160};
  const Scout scout(still, options);
  EXPECT_FALSE(scout.Look(clip->Read(200)).where.empty());  // x = 55
  EXPECT_TRUE(scout.Look(clip->Read(400)).where.empty());   // x = 205
}

TEST(Scout, FourGlimpsesSeeWhatALookSees) {
  for (const std::int32_t depth : {8, 12}) {
    const Watched watched(depth);
    const auto& [scene, clip, still] = watched;
    const Scout scout(still);
    int for_nothing = 0;
    for (std::int64_t index = 0; index < 600; index += 29) {
      const auto look = scout.Look(*clip, index);
      const auto whole = scout.Look(clip->Read(index));
      ASSERT_EQ(look.where.size(), whole.where.size());
      bool glimpsed = false;
      for (int phase = 0; phase < 4; ++phase) {
        glimpsed |= scout.Glimpse(*clip, index, phase);
      }
      EXPECT_TRUE(glimpsed || look.where.empty()) << index;
      for_nothing += look.where.empty() && glimpsed;
    }
    EXPECT_LE(for_nothing, 1);
  }
}

TEST(Scout, AGhostDiffers) {
  const Watched watched;
  const auto& [scene, clip, still] = watched;
  const Background ghost = EstimateBackground(*clip, 300, 310);
  const Background empty = EstimateBackground(*clip, 0, 60);
  EXPECT_TRUE(Scout(still).Differs(Scout(ghost)));
  EXPECT_FALSE(Scout(still).Differs(Scout(empty)));
  ScoutOptions known;  // where it is, all is kept anyhow
  known.always = {{90, 60, 80, 80}};
  EXPECT_FALSE(Scout(still, known).Differs(Scout(ghost)));
}

}  // namespace
}  // namespace touchdown::vision
