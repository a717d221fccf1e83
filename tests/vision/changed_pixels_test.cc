// Pixels that differ from the still picture, against the definition.
#include "detection/changed_pixels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

namespace touchdown::vision {
namespace {

// A window of a picture of noise, before a background of other noise.
struct Scene {
  std::vector<std::uint16_t> wide;
  std::vector<std::uint8_t> narrow;
  Background background;
  core::Frame frame;  // the picture without its first row and two columns
};

constexpr std::int32_t kWidth_px = 41;
constexpr std::int32_t kHeight_px = 13;

Scene MakeScene(std::int32_t bit_depth, unsigned seed) {
  Scene scene;
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> level(80, 120);
  scene.background.width_px = kWidth_px;
  scene.background.height_px = kHeight_px;
  for (std::int32_t i = 0; i < kWidth_px * kHeight_px; ++i) {
    scene.background.level.push_back(static_cast<float>(level(random)) + 0.25F);
    scene.wide.push_back(static_cast<std::uint16_t>(level(random)));
    scene.narrow.push_back(static_cast<std::uint8_t>(scene.wide.back()));
  }
  core::Frame& frame = scene.frame;
  frame.bit_depth = bit_depth;
  const std::int32_t bytes = bit_depth > 8 ? 2 : 1;
  frame.origin_x_px = 2;
  frame.origin_y_px = 1;
  frame.width_px = kWidth_px - 2;
  frame.height_px = kHeight_px - 1;
  frame.stride_bytes = kWidth_px * bytes;
  frame.data = (bit_depth > 8
                    ? reinterpret_cast<const std::byte*>(scene.wide.data())
                    : reinterpret_cast<const std::byte*>(scene.narrow.data())) +
               frame.stride_bytes + frame.origin_x_px * bytes;
  return scene;
}

// Mirrored about the outermost pixel of `count`.
std::int32_t Mirror(std::int32_t at, std::int32_t count) {
  if (count == 1) return 0;
  if (at < 0) return -at;
  return at < count ? at : 2 * (count - 1) - at;
}

double MeanDifference(const Scene& scene, const core::PixelRect& window,
                      std::int32_t x, std::int32_t y) {
  double sum = 0.0;
  for (std::int32_t j = -1; j <= 1; ++j) {
    for (std::int32_t i = -1; i <= 1; ++i) {
      const std::int32_t u = window.x + Mirror(x + i, window.width);
      const std::int32_t v = window.y + Mirror(y + j, window.height);
      const std::int32_t still = (v + scene.frame.origin_y_px) * kWidth_px + u +
                                 scene.frame.origin_x_px;
      sum += static_cast<double>(scene.frame.at(u, v)) -
             static_cast<double>(
                 scene.background.level[static_cast<std::size_t>(still)]);
    }
  }
  return sum / 9.0;
}

TEST(ChangedPixels, AreThoseWhoseMeanDiffers) {
  constexpr float kThreshold_dn = 8.0F;
  ChangedPixels changed;  // the same for all: it is overwritten
  for (const std::int32_t depth : {8, 12}) {
    const Scene scene = MakeScene(depth, 7);
    for (const core::PixelRect& window :
         {core::PixelRect{0, 0, kWidth_px - 2, kHeight_px - 1},
          core::PixelRect{5, 3, 17, 6}, core::PixelRect{4, 2, 1, 9},
          core::PixelRect{4, 2, 2, 2}, core::PixelRect{0, 5, 30, 1}}) {
      FindChangedPixels(scene.frame, scene.background, window, kThreshold_dn,
                        changed);
      std::int32_t marked = 0;
      std::int32_t first = window.height;
      std::int32_t last = 0;
      for (std::int32_t y = 0; y < window.height; ++y) {
        for (std::int32_t x = 0; x < window.width; ++x) {
          const bool expected = std::abs(MeanDifference(scene, window, x, y)) >
                                double{kThreshold_dn};
          EXPECT_EQ(
              changed.mask[static_cast<std::size_t>(y * changed.width_px + x)],
              expected ? 255 : 0)
              << x << "," << y << " of " << window.width << "x"
              << window.height;
          if (!expected) continue;
          ++marked;
          first = std::min(first, y);
          last = y + 1;
        }
      }
      if (marked == 0) {
        EXPECT_EQ(changed.first_row, changed.last_row);
      } else {
        EXPECT_EQ(changed.first_row, first);
        EXPECT_EQ(changed.last_row, last);
      }
    }
  }
}

TEST(ChangedPixels, AreNoneWhereNothingDiffers) {
  Scene scene = MakeScene(8, 9);
  ChangedPixels changed;
  const core::PixelRect window{0, 0, kWidth_px - 2, kHeight_px - 1};
  FindChangedPixels(scene.frame, scene.background, window, 3.0F, changed);
  ASSERT_LT(changed.first_row, changed.last_row);
  for (std::size_t i = 0; i < scene.narrow.size(); ++i) {
    scene.background.level[i] = static_cast<float>(scene.narrow[i]) + 2.9F;
  }
  FindChangedPixels(scene.frame, scene.background, window, 3.0F, changed);
  EXPECT_EQ(changed.first_row, changed.last_row);
}

}  // namespace
}  // namespace touchdown::vision
