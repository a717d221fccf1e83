#include "vision/src/detection/detect.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "touchdown/core/frame.h"

namespace touchdown::vision {
namespace {

constexpr std::int32_t kWidth = 400;
constexpr std::int32_t kHeight = 300;
constexpr std::uint8_t kStill_dn = 100;

Background MakeStill() {
  Background still;
  still.width_px = kWidth;
  still.height_px = kHeight;
  still.level.assign(std::size_t{kWidth} * kHeight, kStill_dn);
  still.noise_floor_dn2 = 0.1;
  return still;
}

struct Picture {
  std::vector<std::uint8_t> levels =
      std::vector<std::uint8_t>(std::size_t{kWidth} * kHeight, kStill_dn);

  void PaintSquare(std::int32_t x, std::int32_t y, std::int32_t side,
                   int contrast_dn) {
    for (std::int32_t j = y; j < y + side; ++j) {
      for (std::int32_t i = x; i < x + side; ++i) {
        levels[static_cast<std::size_t>(j) * kWidth +
               static_cast<std::size_t>(i)] =
            static_cast<std::uint8_t>(kStill_dn + contrast_dn);
      }
    }
  }

  core::Frame View() const {
    core::Frame frame;
    frame.data = reinterpret_cast<const std::byte*>(levels.data());
    frame.stride_bytes = kWidth;
    frame.width_px = kWidth;
    frame.height_px = kHeight;
    return frame;
  }
};

// As in compressed pictures: hundreds of specks. The body, and what is as
// strong by its area, must not be lost among them.
TEST(DetectBlobs, KeepsTheStrongestOfManySpecks) {
  Picture picture;
  int specks = 0;
  for (std::int32_t y = 4; y < 160; y += 10) {
    for (std::int32_t x = 4; x < kWidth - 8; x += 10) {
      picture.PaintSquare(x, y, 3 + specks % 3, specks % 2 == 0 ? 6 : -9);
      ++specks;
    }
  }
  ASSERT_GT(specks, 500);
  picture.PaintSquare(40, 200, 20, 60);    // the body
  picture.PaintSquare(150, 180, 90, 2);    // large and faint
  picture.PaintSquare(300, 200, 8, -100);  // small and strong
  DetectOptions options;
  options.most_blobs = 3;
  const std::vector<Blob> blobs =
      DetectBlobs(picture.View(), MakeStill(), options);
  ASSERT_EQ(blobs.size(), 3U);
  EXPECT_NEAR(blobs[0].centre.x_px, 49.5, 0.5);
  EXPECT_NEAR(blobs[0].centre.y_px, 209.5, 0.5);
  EXPECT_NEAR(blobs[1].centre.x_px, 194.5, 0.5);
  EXPECT_NEAR(blobs[2].centre.x_px, 303.5, 0.5);
  EXPECT_LT(blobs[2].contrast_dn, 0.0);
}

TEST(DetectBlobs, FindsNothingInTheStillPicture) {
  EXPECT_TRUE(DetectBlobs(Picture().View(), MakeStill(), {}).empty());
}

}  // namespace
}  // namespace touchdown::vision
