// Frames that are decoded once.
#include "touchdown/vision/footage/decoded_once.h"

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

namespace touchdown::vision {
namespace {

// 8 x 4 pixels of 8 bits, which show the frame and their place: 32 bytes.
class Numbered final : public Clip {
 public:
  Numbered(bool windows_are_cheap, std::vector<std::int64_t>& decoded)
      : windows_are_cheap_(windows_are_cheap), decoded_(decoded) {
    info_.width_px = 8;
    info_.height_px = 4;
    info_.bit_depth = 8;
    info_.frames = 9;
  }
  const ClipInfo& info() const override { return info_; }
  bool windows_are_cheap() const override { return windows_are_cheap_; }
  std::int64_t EntryFrame(std::int64_t index) const override {
    return index - index % 4;
  }

 protected:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    decoded_.push_back(index);
    samples_.clear();
    for (std::int32_t y = window.y; y < window.y + window.height; ++y) {
      for (std::int32_t x = window.x; x < window.x + window.width; ++x) {
        samples_.push_back(static_cast<std::uint8_t>(32 * index + 8 * y + x));
      }
    }
    core::Frame frame;
    frame.data = reinterpret_cast<const std::byte*>(samples_.data());
    frame.stride_bytes = window.width;
    frame.bit_depth = 8;
    frame.time_s = 0.5 * static_cast<double>(index);
    return frame;
  }

 private:
  bool windows_are_cheap_;
  std::vector<std::int64_t>& decoded_;
  ClipInfo info_;
  std::vector<std::uint8_t> samples_;
};

TEST(DecodedOnce, WhatIsReadAgainIsNotDecodedAgain) {
  std::vector<std::int64_t> decoded;
  const auto clip = DecodeOnce(std::make_unique<Numbered>(false, decoded));
  for (const std::int64_t index : {5, 2, 5, 2, 2}) {
    const core::Frame frame = clip->Read(index, {3, 1, 4, 2});
    EXPECT_EQ(frame.index, index);
    EXPECT_EQ(frame.time_s, 0.5 * static_cast<double>(index));
    EXPECT_EQ(frame.origin_x_px, 3);
    EXPECT_EQ(frame.width_px, 4);
    for (std::int32_t y = 0; y < 2; ++y) {
      for (std::int32_t x = 0; x < 4; ++x) {
        EXPECT_EQ(frame.at(x, y), (32 * index + 8 * (y + 1) + x + 3) % 256);
      }
    }
  }
  EXPECT_EQ(decoded, (std::vector<std::int64_t>{5, 2}));
  EXPECT_EQ(clip->EntryFrame(6), 4);
}

TEST(DecodedOnce, KeepsNoMoreThanItMay) {
  std::vector<std::int64_t> decoded;
  DecodedOnceOptions two;
  two.most_bytes = 95;  // of 32 bytes each
  const auto clip = DecodeOnce(std::make_unique<Numbered>(false, decoded), two);
  for (int round = 0; round < 2; ++round) {
    for (std::int64_t index = 0; index < 4; ++index) {
      EXPECT_EQ(clip->Read(index).at(7, 3), (32 * index + 31) % 256);
    }
  }
  EXPECT_EQ(decoded, (std::vector<std::int64_t>{0, 1, 2, 3, 2, 3}));
}

TEST(DecodedOnce, KeepsNoMoreAfterTheLooks) {
  std::vector<std::int64_t> decoded;
  const auto looks = std::make_shared<bool>(true);
  DecodedOnceOptions options;
  options.looks = looks;
  const auto clip =
      DecodeOnce(std::make_unique<Numbered>(false, decoded), options);
  clip->Read(3);
  *looks = false;
  for (const std::int64_t index : {3, 4, 4}) {
    EXPECT_EQ(clip->Read(index).at(0, 0), (32 * index) % 256);
  }
  EXPECT_EQ(decoded, (std::vector<std::int64_t>{3, 4, 4}));
}

TEST(DecodedOnce, ARawClipStaysAsItIs) {
  std::vector<std::int64_t> decoded;
  auto raw = std::make_unique<Numbered>(true, decoded);
  const Clip* const same = raw.get();
  EXPECT_EQ(DecodeOnce(std::move(raw)).get(), same);
}

}  // namespace
}  // namespace touchdown::vision
