// A recording in which everything moves: much to look at, and nothing to find.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <random>
#include <vector>

#include "touchdown/vision/footage/clip_writer.h"

namespace touchdown::testing {

// 8-bit .mraw of `frames` pictures of width x height, each of squares of `side`
// px with levels that have nothing to do with those of the frame before.
inline void WriteBusyClip(const std::filesystem::path& path, int frames,
                          int width = 640, int height = 480, int side = 16) {
  std::mt19937_64 random(7);
  std::vector<std::byte> pixels(static_cast<std::size_t>(width) *
                                static_cast<std::size_t>(height));
  core::Frame frame;
  frame.data = pixels.data();
  frame.width_px = width;
  frame.height_px = height;
  frame.stride_bytes = width;
  frame.bit_depth = 8;
  vision::MrawOptions options;
  options.fps = 1000.0;
  int made = 0;
  vision::WriteMraw(path, options, [&]() -> std::optional<core::Frame> {
    if (made++ == frames) return std::nullopt;
    for (int top = 0; top < height; top += side) {
      for (int left = 0; left < width; left += side) {
        const auto level = static_cast<std::byte>(random() >> 56);
        for (int y = top; y < std::min(top + side, height); ++y) {
          for (int x = left; x < std::min(left + side, width); ++x) {
            pixels[static_cast<std::size_t>(y) *
                       static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(x)] = level;
          }
        }
      }
    }
    return frame;
  });
}

}  // namespace touchdown::testing
