// Levels between the pixels of a frame.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "touchdown/core/frame.h"

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

// Of samples of one type; (x, y) counts from sample (0, 0) of the view. Nothing
// where a sample that it takes lies outside.
template <class Sample>
std::optional<float> InterpolateCubic(const core::Frame& frame, double x,
                                      double y) {
  const double left = std::floor(x);
  const double top = std::floor(y);
  if (!(left >= 1.0 && top >= 1.0 && left + 2.0 < frame.width_px &&
        top + 2.0 < frame.height_px)) {
    return std::nullopt;
  }
  const std::array<float, 4> across =
      CubicWeights(static_cast<float>(x - left));
  const std::array<float, 4> down = CubicWeights(static_cast<float>(y - top));
  const auto column = static_cast<std::int32_t>(left) - 1;
  const auto row = static_cast<std::int32_t>(top) - 1;
  float sum = 0.0F;
  for (std::int32_t j = 0; j < 4; ++j) {
    const Sample* const levels = frame.row<Sample>(row + j) + column;
    float of_row = 0.0F;
    for (std::size_t i = 0; i < 4; ++i) {
      of_row += across[i] * static_cast<float>(levels[i]);
    }
    sum += down[static_cast<std::size_t>(j)] * of_row;
  }
  return sum;
}

}  // namespace touchdown::vision
