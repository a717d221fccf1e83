// Levels between the pixels of a frame.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace touchdown::vision {

// Weights of the samples at -1, 0, 1 and 2 for a place `t` (0..1) from sample
// 0: cubic convolution with a = -1/2, exact for parabolas (Keys 1981,
// doi:10.1109/TASSP.1981.1163711, eq. 15).
inline std::array<float, 4> CubicWeights(float t) {
  const float t2 = t * t;
  const float t3 = t2 * t;
  return {0.5F * (-t3 + 2.0F * t2 - t), 0.5F * (3.0F * t3 - 5.0F * t2 + 2.0F),
          0.5F * (-3.0F * t3 + 4.0F * t2 + t), 0.5F * (t3 - t2)};
}

// Of a picture whose sample (i, j) is level_at(i, j), for places from its
// sample (0, 0) on. Nothing where a sample that it takes lies outside.
template <class LevelAt>
std::optional<float> InterpolateCubic(std::int32_t width, std::int32_t height,
                                      double x, double y,
                                      const LevelAt& level_at) {
  const double left = std::floor(x);
  const double top = std::floor(y);
  if (!(left >= 1.0 && top >= 1.0 && left + 2.0 < width &&
        top + 2.0 < height)) {
    return std::nullopt;
  }
  const std::array<float, 4> across =
      CubicWeights(static_cast<float>(x - left));
  const std::array<float, 4> down = CubicWeights(static_cast<float>(y - top));
  const auto column = static_cast<std::int32_t>(left) - 1;
  const auto row = static_cast<std::int32_t>(top) - 1;
  float sum = 0.0F;
  for (std::int32_t j = 0; j < 4; ++j) {
    float of_row = 0.0F;
    for (std::int32_t i = 0; i < 4; ++i) {
      of_row += across[static_cast<std::size_t>(i)] *
                static_cast<float>(level_at(column + i, row + j));
    }
    sum += down[static_cast<std::size_t>(j)] * of_row;
  }
  return sum;
}

}  // namespace touchdown::vision
