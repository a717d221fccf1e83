// The body's own picture: levels over the body's coordinates, a cubic B-spline
//   T(x, y) = sum_ij c_ij beta3(x / d - i) beta3(y / d - j)
// with the spacing d of one pixel. (Unser, IEEE Signal Process. Mag. 16(6),
// 1999.) Its gradient is that of the same sum, so that alignment and picture
// agree to rounding.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "layers/shape_cover.h"
#include "numbers/lanes.h"

namespace touchdown::vision::layers {

// The four weights of a cubic B-spline at `share` (0..1) beyond a knot, and
// their derivatives.
inline FourFloats SplineWeights(float share) {
  constexpr float kSixth = 1.0F / 6.0F;  // of the cubic B-spline's weights
  const FourFloats constant = {kSixth, 4.0F * kSixth, kSixth, 0.0F};
  const FourFloats linear = {-0.5F, 0.0F, 0.5F, 0.0F};
  const FourFloats square = {0.5F, -1.0F, 0.5F, 0.0F};
  const FourFloats cube = {-kSixth, 0.5F, -0.5F, kSixth};
  return constant + share * (linear + share * (square + share * cube));
}
inline FourFloats SplineSlopes(float share) {
  const FourFloats constant = {-0.5F, 0.0F, 0.5F, 0.0F};
  const FourFloats linear = {1.0F, -2.0F, 1.0F, 0.0F};
  const FourFloats square = {-0.5F, 1.5F, -1.5F, 0.5F};
  return constant + share * (linear + share * square);
}

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
  SplinePlace LocatePlace(float x, float y) const {
    const float column =
        std::clamp(x + origin_x_, 1.0F, static_cast<float>(columns_) - 2.001F);
    const float row =
        std::clamp(y + origin_y_, 1.0F, static_cast<float>(rows_) - 2.001F);
    const auto whole_column = static_cast<std::int32_t>(column);
    const auto whole_row = static_cast<std::int32_t>(row);
    return {(whole_row - 1) * columns_ + whole_column - 1,
            column - static_cast<float>(whole_column),
            row - static_cast<float>(whole_row)};
  }
  // The place of coefficient (column, row).
  float x_of(std::int32_t column) const {
    return static_cast<float>(column) - origin_x_;
  }
  float y_of(std::int32_t row) const {
    return static_cast<float>(row) - origin_y_;
  }

  // The sixteen weights of a place, row by row.
  using PlaceWeights = std::array<FourFloats, 4>;
  TOUCHDOWN_INLINE static PlaceWeights WeighPlace(const SplinePlace& place) {
    const FourFloats across = SplineWeights(place.right);
    const FourFloats down = SplineWeights(place.below);
    return {down[0] * across, down[1] * across, down[2] * across,
            down[3] * across};
  }
  TOUCHDOWN_INLINE float EvaluateSpline(const float* coefficients,
                                        const SplinePlace& place,
                                        const PlaceWeights& weights) const {
    return AddUp(SumDown(coefficients, place, weights));
  }
  float EvaluateSpline(const float* coefficients,
                       const SplinePlace& place) const {
    return EvaluateSpline(coefficients, place, WeighPlace(place));
  }
  struct Tilt {
    float value = 0.0F;
    float by_x = 0.0F;
    float by_y = 0.0F;
  };
  Tilt EvaluateTilt(const float* coefficients, const SplinePlace& place) const {
    const FourFloats across = SplineWeights(place.right);
    const FourFloats down =
        SumDown(coefficients, place, SplineWeights(place.below));
    return {AddUp(down * across), AddUp(down * SplineSlopes(place.right)),
            AddUp(SumDown(coefficients, place, SplineSlopes(place.below)) *
                  across)};
  }
  // The transpose of EvaluateSpline: adds `amount` times each weight.
  TOUCHDOWN_INLINE void Spread(float amount, const SplinePlace& place,
                               const PlaceWeights& weights,
                               float* coefficients) const {
    float* row = coefficients + place.first;
    for (std::size_t j = 0; j < 4; ++j, row += columns_) {
      StoreFour(LoadFour(row) + amount * weights[j], row);
    }
  }
  void Spread(float amount, const SplinePlace& place,
              float* coefficients) const {
    Spread(amount, place, WeighPlace(place), coefficients);
  }

  // Levels at the knots to the coefficients of the spline through them (the
  // direct B-spline transform of Unser, section "interpolation"), with
  // coefficients of 0 beyond the grid: a symmetric matrix, its own transpose.
  void TransformLevels(float* levels) const;

 private:
  static float AddUp(const FourFloats& four) {
    return (four[0] + four[2]) + (four[1] + four[3]);
  }
  // The sum of four rows of coefficients, each times its weight or its four.
  template <class Weights>
  TOUCHDOWN_INLINE FourFloats SumDown(const float* coefficients,
                                      const SplinePlace& place,
                                      const Weights& weights) const {
    const float* row = coefficients + place.first;
    FourFloats sum = weights[0] * LoadFour(row);
    for (std::size_t j = 1; j < 4; ++j) {
      row += columns_;
      sum += weights[j] * LoadFour(row);
    }
    return sum;
  }

  std::int32_t columns_ = 0;
  std::int32_t rows_ = 0;
  float origin_x_ = 0.0F;
  float origin_y_ = 0.0F;
};

}  // namespace touchdown::vision::layers
