// A dark block before an uneven wall, with noise, whose path a test gives.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "tests/vision/drawn_clip.h"

namespace touchdown::vision::synthetic {

struct BlockPose {
  double x_px = 0.0;
  double y_px = 0.0;
  double angle_rad = 0.0;
};

struct DrawnBlock {
  std::int32_t width_px = 200;
  std::int32_t height_px = 120;
  std::int64_t frames = 40;
  double half_long_px = 24.0;
  double half_short_px = 8.0;
  double level_dn = 60.0;
  double noise_dn = 2.0;         // uniform, of this standard deviation
  std::int64_t noise_lasts = 1;  // frames: a codec repeats its errors
  double noise_grows = 0.0;      // of noise_dn, more with each frame
  std::function<BlockPose(std::int64_t frame)> pose;
  double gamma = 1.0;  // of the camera (linear_clip.h)
  // DN more at a place of the body, in px along its sides.
  std::function<double(double along_px, double across_px)> face =
      [](double, double) { return 0.0; };
};

// The same number for the same place and frame, uniform in [-1, 1).
inline double HashNoise(std::uint32_t x, std::uint32_t y, std::uint32_t t) {
  std::uint32_t h = x * 0x9E3779B1U ^ y * 0x85EBCA77U ^ t * 0xC2B2AE3DU;
  h ^= h >> 15;
  h *= 0x2C1B3C6DU;
  h ^= h >> 12;
  h *= 0x297A2D39U;
  h ^= h >> 15;
  return static_cast<double>(h) / 2147483648.0 - 1.0;
}

inline std::unique_ptr<Clip> DrawBlock(const DrawnBlock& block) {
  constexpr double kFull_dn = 255.0;
  const auto draw = [block](std::int64_t frame, std::vector<double>& levels) {
    const BlockPose pose = block.pose(frame);
    const double cosine = std::cos(pose.angle_rad);
    const double sine = std::sin(pose.angle_rad);
    // An edge's blur of 0.8 px; the slabs' product is exact for a Gaussian.
    const auto slab = [](double half, double at) {
      constexpr double kBlur_px = 0.8;
      const double scale = kBlur_px * std::sqrt(2.0);
      return 0.5 *
             (std::erf((half - at) / scale) + std::erf((half + at) / scale));
    };
    for (std::int32_t y = 0; y < block.height_px; ++y) {
      for (std::int32_t x = 0; x < block.width_px; ++x) {
        const double dx = x - pose.x_px;
        const double dy = y - pose.y_px;
        const double along = cosine * dx + sine * dy;
        const double across = -sine * dx + cosine * dy;
        const double cover =
            slab(block.half_long_px, along) * slab(block.half_short_px, across);
        const double wall =
            150.0 + 20.0 * std::sin(0.05 * x) + 15.0 * std::cos(0.09 * y);
        const double noise =
            std::sqrt(3.0) * block.noise_dn *
            (1.0 + block.noise_grows * static_cast<double>(frame)) *
            HashNoise(static_cast<std::uint32_t>(x),
                      static_cast<std::uint32_t>(y),
                      static_cast<std::uint32_t>(frame / block.noise_lasts));
        const double level = block.level_dn + block.face(along, across);
        const double light = wall + cover * (level - wall);
        levels.push_back(kFull_dn * std::pow(light / kFull_dn, block.gamma) +
                         noise);
      }
    }
  };
  constexpr double kFps = 1000.0;
  return std::make_unique<DrawnClip>(block.width_px, block.height_px,
                                     block.frames, kFps, draw);
}

// A block of 48 px that goes 60 px in all, its own length and a quarter: one
// pixel is covered in four frames of five.
inline DrawnBlock SlowBlock() {
  DrawnBlock block;
  block.pose = [](std::int64_t frame) {
    const auto t = static_cast<double>(frame);
    return BlockPose{70.0 + 1.5 * t, 70.0 - 0.01 * (t - 20.0) * (t - 20.0),
                     0.01 * (t - 20.0)};
  };
  return block;
}

// The same, higher; half of what is drawn on it looks like the wall, so that no
// outline shows it.
inline DrawnBlock SlowBlockLikeTheWall() {
  DrawnBlock block = SlowBlock();
  block.half_short_px = 14.0;
  block.level_dn = 110.0;
  block.face = [](double along, double across) {
    return 60.0 * std::sin(0.4 * along) * std::cos(0.3 * across);
  };
  return block;
}

}  // namespace touchdown::vision::synthetic
