#include "app/review/thumbnail.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/review/lab.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::review {
namespace {

// 192 x 144: left half dark, right half light.
template <class Sample>
core::Frame Halves(std::vector<Sample>& pixels, Sample light, int bit_depth) {
  constexpr int kWidth = 192, kHeight = 144;
  pixels.assign(kWidth * kHeight, Sample{0});
  for (int y = 0; y < kHeight; ++y) {
    for (int x = kWidth / 2; x < kWidth; ++x) {
      pixels[static_cast<std::size_t>(y * kWidth + x)] = light;
    }
  }
  core::Frame frame;
  frame.data = reinterpret_cast<const std::byte*>(pixels.data());
  frame.stride_bytes = kWidth * static_cast<std::ptrdiff_t>(sizeof(Sample));
  frame.width_px = kWidth;
  frame.height_px = kHeight;
  frame.bit_depth = bit_depth;
  return frame;
}

TEST(Shrunk, ShowsThePartAskedForInEightBits) {
  std::vector<std::uint16_t> pixels;
  const core::Frame frame = Halves<std::uint16_t>(pixels, 1000, 12);
  const vision::Image image = Shrunk(frame, {96, 72}, 192, 1000);
  ASSERT_EQ(image.width_px, kThumbnailWidth_px);
  ASSERT_EQ(image.height_px, kThumbnailHeight_px);
  EXPECT_EQ(image.View().at(10, 36), 0u);
  EXPECT_EQ(image.View().at(90, 36), 255u);
}

TEST(Shrunk, IsBlackBeyondTheFrame) {
  std::vector<std::uint8_t> pixels;
  const core::Frame frame = Halves<std::uint8_t>(pixels, 200, 8);
  const vision::Image image = Shrunk(frame, {192, 72}, 96, 255);
  EXPECT_EQ(image.View().at(10, 36), 200u);
  EXPECT_EQ(image.View().at(90, 36), 0u);
}

TEST(Shrunk, RefusesAWidthThatIsNone) {
  std::vector<std::uint8_t> pixels;
  const core::Frame frame = Halves<std::uint8_t>(pixels, 200, 8);
  EXPECT_THROW(Shrunk(frame, {0, 0}, 0, 255), std::invalid_argument);
}

TEST(RenderThumbnail, ShowsTheContact) {
  const Lab lab;
  ClipShelf shelf;
  const Picture picture = RenderThumbnail(shelf, lab.Now());
  EXPECT_EQ(picture.type, "image/jpeg");
  const auto file = lab.folder.Write("small.jpg", *picture.bytes);
  const vision::Image image = vision::ReadImage(file);
  ASSERT_EQ(image.width_px, kThumbnailWidth_px);
  // The body's lowest point is in the middle: dark above, ground below.
  EXPECT_LT(image.View().at(48, 28) + 40, image.View().at(4, 4));
}

}  // namespace
}  // namespace touchdown::review
