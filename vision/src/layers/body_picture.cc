#include "layers/body_picture.h"

#include <cmath>
#include <cstddef>
#include <vector>

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

void PictureGrid::TransformLevels(float* levels) const {
  // Along each direction c[i-1] + 4 c[i] + c[i+1] = 6 l[i]: by Cholesky's
  // factors of the tridiagonal matrix, whose pivots soon no longer change.
  const auto solve = [](float* first, std::ptrdiff_t count, std::ptrdiff_t step,
                        std::ptrdiff_t beside, std::ptrdiff_t beside_step) {
    std::vector<float> inverse_pivots;
    float inverse = 0.0F;
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      inverse = 1.0F / (4.0F - inverse);
      inverse_pivots.push_back(inverse);
      float* const at = first + i * step;
      for (std::ptrdiff_t k = 0; k < beside; ++k) {
        float& level = at[k * beside_step];
        const float before = i > 0 ? at[k * beside_step - step] : 0.0F;
        level = (6.0F * level - before) * inverse;
      }
    }
    for (std::ptrdiff_t i = count - 2; i >= 0; --i) {
      const float by = inverse_pivots[static_cast<std::size_t>(i)];
      float* const at = first + i * step;
      for (std::ptrdiff_t k = 0; k < beside; ++k) {
        at[k * beside_step] -= by * at[k * beside_step + step];
      }
    }
  };
  solve(levels, rows_, columns_, columns_, 1);
  solve(levels, columns_, 1, rows_, columns_);
}

}  // namespace touchdown::vision::layers
