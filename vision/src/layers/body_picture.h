// The body's own picture: levels over the body's coordinates, a cubic B-spline
//   T(x, y) = sum_ij c_ij beta3(x / d - i) beta3(y / d - j)
// with the spacing d of one pixel. (Unser, IEEE Signal Process. Mag. 16(6),
// 1999.) Its gradient is that of the same sum, so that alignment and picture
// agree to rounding.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "layers/shape_cover.h"

namespace touchdown::vision::layers {

// The four weights of a cubic B-spline at `share` (0..1) beyond a knot, and
// their derivatives.
struct SplineWeights {
  std::array<float, 4> at;
  explicit SplineWeights(float share) {
    const float rest = 1.0F - share;
    constexpr float kSixth = 1.0F / 6.0F;  // of the cubic B-spline's weights
    at[0] = rest * rest * rest * kSixth;
    at[1] = (4.0F + share * share * (3.0F * share - 6.0F)) * kSixth;
    at[2] = (4.0F + rest * rest * (3.0F * rest - 6.0F)) * kSixth;
    at[3] = share * share * share * kSixth;
  }
};
struct SplineSlopes {
  std::array<float, 4> at;
  explicit SplineSlopes(float share) {
    const float rest = 1.0F - share;
    at[0] = -0.5F * rest * rest;
    at[1] = 0.5F * share * (3.0F * share - 4.0F);
    at[2] = -0.5F * rest * (3.0F * rest - 4.0F);
    at[3] = 0.5F * share * share;
  }
};

// Where a place of the body lies on the grid: the first of its sixteen
// coefficients, and how far beyond.
struct SplinePlace {
  std::int32_t first = 0;
  float right = 0.0F;
  float below = 0.0F;
};

// The grid of coefficients: the shape and a rim for its blurred edge.
class PictureGrid {
 public:
  PictureGrid() = default;
  PictureGrid(const Shape& shape, double rim);

  std::int32_t columns() const { return columns_; }
  std::int32_t rows() const { return rows_; }
  std::size_t size() const {
    return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  }
  // Places beyond the rim are those of its border.
  SplinePlace LocatePlace(float x, float y) const;
  // The place of coefficient (column, row).
  float x_of(std::int32_t column) const {
    return static_cast<float>(column) - origin_x_;
  }
  float y_of(std::int32_t row) const {
    return static_cast<float>(row) - origin_y_;
  }

  float EvaluateSpline(const float* coefficients,
                       const SplinePlace& place) const;
  struct Tilt {
    float value = 0.0F;
    float by_x = 0.0F;
    float by_y = 0.0F;
  };
  Tilt EvaluateTilt(const float* coefficients, const SplinePlace& place) const;
  // The transpose of EvaluateSpline: adds `amount` times each weight.
  void Spread(float amount, const SplinePlace& place,
              float* coefficients) const;

 private:
  std::int32_t columns_ = 0;
  std::int32_t rows_ = 0;
  float origin_x_ = 0.0F;
  float origin_y_ = 0.0F;
};

}  // namespace touchdown::vision::layers
