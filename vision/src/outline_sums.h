// The sums of one round of an outline's fit: normal equations of weighted least
// squares, and what the residuals say.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "outline_image.h"

namespace touchdown::vision {

// The pixels of a fit, column by column, padded to whole blocks. Columns may be
// longer than that.
struct OutlinePixels {
  std::size_t size = 0;  // without the padding
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> value;       // DN
  std::vector<double> background;  // DN
  std::vector<double> behind;      // DN, of what the body hides here
  std::vector<double> per_noise;   // 1/DN; 0: padding
  // Of what is added to the interior's levels and moves with the body, DN/px;
  // used where `sloped`.
  std::vector<double> slope_x;
  std::vector<double> slope_y;
  bool sloped = false;

  std::size_t padded() const { return (size + kBlock - 1) / kBlock * kBlock; }
  // None yet, and room for so many.
  void Clear(std::size_t room);
  void Add(double x_px, double y_px, double value_dn, double background_dn,
           double behind_dn) {
    x[size] = x_px;
    y[size] = y_px;
    value[size] = value_dn;
    background[size] = background_dn;
    behind[size] = behind_dn;
    ++size;
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
  void Of(const OutlinePixels& pixels, const OutlineImage& image,
          const OutlineRound& round, std::vector<double>& residuals);

  double normal(std::size_t i, std::size_t j) const;  // j <= i
  double gradient(std::size_t i) const;

  double cost = 0.0;         // weighted squares
  double weights = 0.0;      // sum of the weights
  double inliers = 0.0;      // pixels with more than half weight
  double square = 0.0;       // their squares
  double contrast_dn = 0.0;  // mean of in - out along the outline

 private:
  static constexpr std::size_t kLanes = 8;
  static constexpr std::size_t kPadded = (kMostTerms + 3) / 4 * 4;
  using Lanes = std::array<double, kLanes>;

  friend struct OutlineBlock;
  struct alignas(64) Totals {
    std::array<Lanes, kMostTerms * kPadded> normal;
    std::array<Lanes, kMostTerms> gradient;
    Lanes cost, weights, inliers, square, contrast, contrast_weight;
  };
  Totals totals_;
};

// 1.4826 times the median of the residuals' sizes, and at least 1.
double RobustScale(const std::vector<double>& residuals);

}  // namespace touchdown::vision
