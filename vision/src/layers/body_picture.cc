#include "layers/body_picture.h"

#include <algorithm>
#include <cmath>

namespace touchdown::vision::layers {

PictureGrid::PictureGrid(const Shape& shape, double rim) {
  const auto half_columns =
      static_cast<std::int32_t>(std::ceil(shape.half_long + rim)) + 2;
  const auto half_rows =
      static_cast<std::int32_t>(std::ceil(shape.half_short + rim)) + 2;
  columns_ = 2 * half_columns + 1;
  rows_ = 2 * half_rows + 1;
  origin_x_ = static_cast<float>(half_columns);
  origin_y_ = static_cast<float>(half_rows);
}

SplinePlace PictureGrid::LocatePlace(float x, float y) const {
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

float PictureGrid::EvaluateSpline(const float* coefficients,
                                  const SplinePlace& place) const {
  const SplineWeights across(place.right);
  const SplineWeights down(place.below);
  const float* row = coefficients + place.first;
  float sum = 0.0F;
  for (std::size_t j = 0; j < 4; ++j, row += columns_) {
    sum += down.at[j] * (across.at[0] * row[0] + across.at[1] * row[1] +
                         across.at[2] * row[2] + across.at[3] * row[3]);
  }
  return sum;
}

PictureGrid::Tilt PictureGrid::EvaluateTilt(const float* coefficients,
                                            const SplinePlace& place) const {
  const SplineWeights across(place.right);
  const SplineWeights down(place.below);
  const SplineSlopes across_slope(place.right);
  const SplineSlopes down_slope(place.below);
  const float* row = coefficients + place.first;
  Tilt tilt;
  for (std::size_t j = 0; j < 4; ++j, row += columns_) {
    const float level = across.at[0] * row[0] + across.at[1] * row[1] +
                        across.at[2] * row[2] + across.at[3] * row[3];
    tilt.value += down.at[j] * level;
    tilt.by_y += down_slope.at[j] * level;
    tilt.by_x += down.at[j] *
                 (across_slope.at[0] * row[0] + across_slope.at[1] * row[1] +
                  across_slope.at[2] * row[2] + across_slope.at[3] * row[3]);
  }
  return tilt;
}

void PictureGrid::Spread(float amount, const SplinePlace& place,
                         float* coefficients) const {
  const SplineWeights across(place.right);
  const SplineWeights down(place.below);
  float* row = coefficients + place.first;
  for (std::size_t j = 0; j < 4; ++j, row += columns_) {
    const float share = amount * down.at[j];
    row[0] += share * across.at[0];
    row[1] += share * across.at[1];
    row[2] += share * across.at[2];
    row[3] += share * across.at[3];
  }
}

}  // namespace touchdown::vision::layers
