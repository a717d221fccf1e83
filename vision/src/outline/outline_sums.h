// The sums of one round of an outline's fit: normal equations of weighted least
// squares, and what the residuals say.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <new>
#include <span>
#include <utility>
#include <vector>

#include "outline/outline_image.h"

namespace touchdown::vision {

// Leaves new elements as they are in memory: they are written before they are
// read, and zeroes would cost a fit more than its pixels.
template <class T>
struct Unfilled : std::allocator<T> {
  template <class U>
  struct rebind {  // NOLINT(readability-identifier-naming): the library's name
    using other = Unfilled<U>;
  };
  template <class U>
  void construct(U* place) const {
    ::new (static_cast<void*>(place)) U;
  }
  template <class U, class... From>
  void construct(U* place, From&&... from) const {
    ::new (static_cast<void*>(place)) U(std::forward<From>(from)...);
  }
};

// The pixels of a fit, column by column, padded to whole blocks. Columns may be
// longer than that.
struct OutlinePixels {
  using Column = std::vector<float, Unfilled<float>>;
  using Places = std::vector<double, Unfilled<double>>;
  std::size_t size = 0;  // without the padding
  Places x;
  Places y;
  Column value;       // DN
  Column background;  // DN
  Column behind;      // DN, of what the body hides here
  Column per_noise;   // 1/DN; 0: padding

  std::size_t padded() const { return (size + kBlock - 1) / kBlock * kBlock; }
  // None yet, and room for so many.
  void Clear(std::size_t room);
  void Add(double x_px, double y_px, double value_dn, double background_dn,
           double behind_dn) {
    x[size] = x_px;
    y[size] = y_px;
    value[size] = static_cast<float>(value_dn);
    background[size] = static_cast<float>(background_dn);
    behind[size] = static_cast<float>(behind_dn);
    ++size;
  }
  // `count` pixels of a row, whose background is what the body hides.
  template <class Sample>
  void AddRun(double x_px, double y_px, std::size_t count,
              const Sample* value_dn, const float* background_dn) {
    for (std::size_t i = 0; i < count; ++i) {
      x[size + i] = x_px + static_cast<double>(i);
    }
    std::fill_n(&y[size], count, y_px);
    for (std::size_t i = 0; i < count; ++i) {
      value[size + i] = static_cast<float>(value_dn[i]);
    }
    std::copy_n(background_dn, count, &background[size]);
    std::copy_n(background_dn, count, &behind[size]);
    size += count;
  }
  // When all are there. The noise's variance is floor + slope * value, at least
  // `least`.
  void Finish(double floor_dn2, double slope_dn, double least_dn2);
  double MeanBackground() const;
};

// What stands in the normal equations' columns, in this order: up to seven
// derivatives of the coverage, then 1, xi, eta, xi^2, xi eta, eta^2 of the
// interior (or 1 alone), then those six of the surround (or none).
inline constexpr std::size_t kMostShape = 7;
inline constexpr std::size_t kMostTerms = kMostShape + 6 + 6;

struct OutlineRound {
  // Which derivatives: members of CoverBlock.
  std::array<std::size_t, kMostShape> shape{};  // 0..4 d_shape, 5, 6: below
  std::size_t shapes = 0;
  // Values of `shape` for the derivatives by blur and by shutter.
  static constexpr std::size_t kBlur = 5;
  static constexpr std::size_t kOpen = 6;

  std::size_t interior = 6;         // terms, 1 or 6
  std::size_t outer = 0;            // terms, 0 (known background) or 6
  std::array<double, 12> levels{};  // DN, of the terms of both; 0 beyond them
  double cut = 0.0;                 // Tukey's, in noise; 0: plain least squares

  std::size_t terms() const { return shapes + interior + outer; }
};

class OutlineSums {
 public:
  // Adds up all pixels; `residuals` (in noise) has as many as they have.
  void SumPixels(const OutlinePixels& pixels, const OutlineImage& image,
                 const OutlineRound& round, std::vector<double>& residuals);

  double normal(std::size_t i, std::size_t j) const;  // j <= i
  double gradient(std::size_t i) const;

  double cost = 0.0;         // weighted squares
  double weights = 0.0;      // sum of the weights
  double inliers = 0.0;      // pixels with more than half weight
  double square = 0.0;       // their squares
  double contrast_dn = 0.0;  // mean of in - out along the outline

 private:
  // Single-precision sums kept side by side, one for each place of a 256-bit
  // vector; rows of the normal matrix, filled up to whole fours.
  static constexpr std::size_t kLanes = 8;
  static constexpr std::size_t kPadded = (kMostTerms + 3) / 4 * 4;
  using Lanes = std::array<float, kLanes>;

  friend struct OutlineBlock;
  // Of a few blocks, in short numbers.
  struct alignas(64) Totals {
    std::array<Lanes, kMostTerms * kPadded> normal;
    std::array<Lanes, kMostTerms> gradient;
    Lanes cost, weights, inliers, square, contrast, contrast_weight;
  };
  void Begin(std::size_t terms);
  void AddTotals(std::size_t terms);

  Totals totals_;
  std::array<double, kMostTerms * kPadded> normal_;
  std::array<double, kMostTerms> gradient_;
  double contrast_ = 0.0;
  double contrast_weight_ = 0.0;
};

// 1.4826 times the median of the residuals' sizes, and at least 1.
double RobustScale(const std::vector<double>& residuals);

}  // namespace touchdown::vision
