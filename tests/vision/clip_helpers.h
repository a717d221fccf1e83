// Pictures with known samples, and what tests of clips ask of them.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "touchdown/core/errors.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::vision {

// Frame `index` of a made-up recording: every sample differs from its
// neighbours in x, y and time, and all bits of the depth occur.
inline Image Pattern(std::int32_t width, std::int32_t height,
                     std::int32_t bit_depth, std::int64_t index) {
  Image image{width, height, bit_depth, {}};
  const auto samples =
      static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  image.pixels.resize(samples * (bit_depth > 8 ? 2 : 1));
  const std::uint32_t mask = (1u << bit_depth) - 1u;
  for (std::size_t i = 0; i < samples; ++i) {
    const auto value = static_cast<std::uint32_t>(
        (i + 1) * 2654435761u + static_cast<std::uint64_t>(index) * 40503u);
    const std::uint32_t sample = (value >> 7) & mask;
    if (bit_depth > 8) {
      reinterpret_cast<std::uint16_t*>(image.pixels.data())[i] =
          static_cast<std::uint16_t>(sample);
    } else {
      image.pixels[i] = static_cast<std::byte>(sample);
    }
  }
  return image;
}

// The samples of a view, row by row.
inline std::vector<std::uint32_t> Samples(const core::Frame& frame) {
  std::vector<std::uint32_t> samples;
  for (std::int32_t y = 0; y < frame.height_px; ++y) {
    for (std::int32_t x = 0; x < frame.width_px; ++x) {
      samples.push_back(frame.at(x, y));
    }
  }
  return samples;
}

// Property: a window equals the crop of the whole frame, and says where it
// lies.
inline void ExpectWindowsAreCrops(Clip& clip, std::int64_t index) {
  const ClipInfo& info = clip.info();
  const Image whole = [&] {
    const core::Frame frame = clip.Read(index);
    Image copy{frame.width_px, frame.height_px, frame.bit_depth, {}};
    for (std::int32_t y = 0; y < frame.height_px; ++y) {
      const std::byte* const row = frame.row<std::byte>(y);
      copy.pixels.insert(copy.pixels.end(), row,
                         row + frame.width_px * (frame.is_16_bit() ? 2 : 1));
    }
    return copy;
  }();
  const std::int32_t w = info.width_px;
  const std::int32_t h = info.height_px;
  for (const core::PixelRect& window :
       {core::PixelRect{0, 0, w, h}, core::PixelRect{1, 1, w - 2, h - 2},
        core::PixelRect{3, 2, 1, 1}, core::PixelRect{w - 3, h - 2, 3, 2},
        core::PixelRect{2, 0, 5, h}}) {
    const core::Frame frame = clip.Read(index, window);
    ASSERT_EQ(frame.width_px, window.width);
    ASSERT_EQ(frame.height_px, window.height);
    EXPECT_EQ(frame.origin_x_px, window.x);
    EXPECT_EQ(frame.origin_y_px, window.y);
    EXPECT_EQ(frame.index, index);
    EXPECT_EQ(frame.bit_depth, info.bit_depth);
    EXPECT_GT(frame.stride_bytes, 0);
    const core::Frame full = whole.View();
    for (std::int32_t y = 0; y < window.height; ++y) {
      for (std::int32_t x = 0; x < window.width; ++x) {
        ASSERT_EQ(frame.at(x, y), full.at(window.x + x, window.y + y))
            << "at " << x << "," << y << " of window " << window.x << ","
            << window.y << "," << window.width << "," << window.height;
      }
    }
  }
}

// Property: a frame is the same whatever was read before it.
inline void ExpectOrderDoesNotMatter(const std::filesystem::path& path,
                                     const ClipOptions& options = {}) {
  const auto clip = OpenClip(path, options);
  const std::int64_t n = clip->info().frames;
  std::vector<std::vector<std::uint32_t>> forward;
  std::vector<double> times;
  for (std::int64_t i = 0; i < n; ++i) {
    const core::Frame frame = clip->Read(i);
    forward.push_back(Samples(frame));
    times.push_back(frame.time_s);
  }
  std::vector<std::int64_t> order;
  for (std::int64_t i = n - 1; i >= 0; --i) order.push_back(i);
  for (std::int64_t i = 0; i < n; ++i) order.push_back(i * 7 % n);
  for (const std::int64_t i : order) {
    const core::Frame frame = clip->Read(i);
    ASSERT_EQ(frame.index, i);
    ASSERT_EQ(frame.time_s, times[static_cast<std::size_t>(i)]);
    ASSERT_EQ(Samples(frame), forward[static_cast<std::size_t>(i)])
        << "frame " << i << " of " << path;
  }
}

// The one line that opening or reading everything gives, or "" if it succeeds.
// An error lane other than core::InputError fails the test.
inline std::string ErrorOf(const std::filesystem::path& path,
                           const ClipOptions& options = {}) {
  try {
    const auto clip = OpenClip(path, options);
    for (std::int64_t i = 0; i < clip->info().frames; ++i) clip->Read(i);
  } catch (const core::InputError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    return text;
  }
  return "";
}

}  // namespace touchdown::vision
