#include "detection/shape_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>

namespace touchdown::vision {
namespace {

// Share of a cell, at distance `at` from the middle of a slab, that the slab
// covers. Exact but for cells that hold both of its edges.
double CoverOfSlab(double half, double at) {
  return std::clamp(half - std::abs(at) + 0.5, 0.0, 1.0);
}

// A disc, or the product of two slabs.
double CoverOfShape(const KnownShape& shape, double x, double y, double cosine,
                    double sine) {
  if (shape.kind == core::BodyKind::kSphere) {
    return CoverOfSlab(0.5 * shape.long_side, std::hypot(x, y));
  }
  return CoverOfSlab(0.5 * shape.long_side, cosine * x + sine * y) *
         CoverOfSlab(0.5 * shape.short_side, -sine * x + cosine * y);
}

// Cells from the shape's centre to its farthest cell, and one more.
std::int32_t ComputeReach(const KnownShape& shape) {
  const double half = shape.kind == core::BodyKind::kSphere
                          ? 0.5 * shape.long_side
                          : 0.5 * std::hypot(shape.long_side, shape.short_side);
  return static_cast<std::int32_t>(std::ceil(half)) + 1;
}

cv::Mat WrapInMat(std::vector<float>& values, std::int32_t width,
                  std::int32_t height) {
  return {height, width, CV_32F, values.data()};
}
cv::Mat WrapInMat(const std::vector<float>& values, std::int32_t width,
                  std::int32_t height) {
  // OpenCV has no view of constant data; it is only read.
  return {height, width, CV_32F, const_cast<float*>(values.data())};
}

// Angles in half a turn at which a rectangle is sought.
std::size_t CountAngles(const KnownShape& shape) {
  if (shape.kind == core::BodyKind::kSphere) return 1;
  // Of the short side: a whole step moves the end of the long side by so much,
  // so that the best angle is never farther off than half of that. Smaller
  // costs time. Not studied.
  constexpr double kMaxEndMove = 0.35;
  // At least, for squares; at most, so that longer bodies are sought at coarser
  // angles. Not studied.
  constexpr double kMinAngles = 12.0;
  constexpr double kMaxAngles = 48.0;
  const double step = 2.0 * kMaxEndMove * shape.short_side / shape.long_side;
  return static_cast<std::size_t>(
      std::clamp(std::ceil(std::numbers::pi / step), kMinAngles, kMaxAngles));
}

// Place of the maximum of a parabola through three values at -1, 0 and 1;
// within half a step.
double TopOfParabola(double before, double at, double after) {
  const double bend = before - 2.0 * at + after;
  if (!(bend < 0.0)) return 0.0;
  return std::clamp(0.5 * (before - after) / bend, -0.5, 0.5);
}

}  // namespace

double SymmetryPeriod(const KnownShape& shape) {
  // Ratio of the sides below which a rectangle counts as a square: it looks the
  // same after a quarter turn. Not studied.
  constexpr double kSquareRatio = 1.05;
  return shape.long_side < kSquareRatio * shape.short_side
             ? 0.5 * std::numbers::pi
             : std::numbers::pi;
}

ShapeSearch::ShapeSearch(const KnownShape& shape, std::int32_t width,
                         std::int32_t height)
    : shape_(shape), width_(width), height_(height) {
  if (!(shape.long_side > 0.0) || !(shape.short_side > 0.0)) {
    throw std::invalid_argument(
        "ShapeSearch: shape of " + std::to_string(shape.long_side) + " x " +
        std::to_string(shape.short_side) + " cells; sides must be above 0");
  }
  if (width < 1 || height < 1) {
    throw std::invalid_argument(
        "ShapeSearch: picture of " + std::to_string(width) + " x " +
        std::to_string(height) + " cells; it must have at least one");
  }
  const std::int32_t reach = ComputeReach(shape);
  // Zeros beyond the border, as far as the shape reaches: a transform wraps
  // around, and what it meets there must be "nothing has changed".
  padded_width_ = cv::getOptimalDFTSize(width + 2 * reach);
  padded_height_ = cv::getOptimalDFTSize(height + 2 * reach);
  const std::size_t count = CountAngles(shape);
  step_rad_ = std::numbers::pi / static_cast<double>(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double angle = static_cast<double>(k) * step_rad_;
    const double cosine = std::cos(angle);
    const double sine = std::sin(angle);
    std::vector<float> kernel(static_cast<std::size_t>(padded_width_) *
                                  static_cast<std::size_t>(padded_height_),
                              0.0F);
    double sum = 0.0;
    for (std::int32_t y = -reach; y <= reach; ++y) {
      for (std::int32_t x = -reach; x <= reach; ++x) {
        const double cover = CoverOfShape(shape, x, y, cosine, sine);
        if (!(cover > 0.0)) continue;
        sum += cover;
        const std::int32_t column = (x + padded_width_) % padded_width_;
        const std::int32_t row = (y + padded_height_) % padded_height_;
        kernel[static_cast<std::size_t>(row) *
                   static_cast<std::size_t>(padded_width_) +
               static_cast<std::size_t>(column)] += static_cast<float>(cover);
      }
    }
    for (float& value : kernel) value /= static_cast<float>(sum);
    std::vector<float> spectrum(kernel.size());
    cv::Mat out = WrapInMat(spectrum, padded_width_, padded_height_);
    cv::dft(WrapInMat(kernel, padded_width_, padded_height_), out);
    spectra_.push_back(std::move(spectrum));
  }
}

// Mean change under the shape at each place, at one angle: correlation by
// Fourier transform.
std::vector<float> ShapeSearch::ScoreAngle(const std::vector<float>& spectrum,
                                           std::size_t angle) const {
  std::vector<float> product(spectrum.size());
  cv::Mat out = WrapInMat(product, padded_width_, padded_height_);
  // Correlation, not convolution.
  constexpr bool kConjugate = true;
  cv::mulSpectrums(WrapInMat(spectrum, padded_width_, padded_height_),
                   WrapInMat(spectra_[angle], padded_width_, padded_height_),
                   out, 0, kConjugate);
  cv::dft(out, out, cv::DFT_INVERSE | cv::DFT_REAL_OUTPUT | cv::DFT_SCALE,
          height_);
  std::vector<float> scores(static_cast<std::size_t>(width_) *
                            static_cast<std::size_t>(height_));
  for (std::int32_t y = 0; y < height_; ++y) {
    const auto row =
        product.begin() + static_cast<std::ptrdiff_t>(y) * padded_width_;
    std::copy(row, row + width_,
              scores.begin() + static_cast<std::ptrdiff_t>(y) * width_);
  }
  return scores;
}

std::vector<PlacedShape> ShapeSearch::FindMaxima(
    const std::vector<float>& change, std::size_t most,
    std::size_t every) const {
  if (change.size() !=
      static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {
    throw std::invalid_argument("ShapeSearch: change picture of " +
                                std::to_string(change.size()) + " cells; " +
                                std::to_string(width_) + " x " +
                                std::to_string(height_) + " were announced");
  }
  std::vector<float> padded(static_cast<std::size_t>(padded_width_) *
                                static_cast<std::size_t>(padded_height_),
                            0.0F);
  for (std::int32_t y = 0; y < height_; ++y) {
    const auto row = change.begin() + static_cast<std::ptrdiff_t>(y) * width_;
    std::copy(row, row + width_,
              padded.begin() + static_cast<std::ptrdiff_t>(y) * padded_width_);
  }
  cv::Mat spectrum = WrapInMat(padded, padded_width_, padded_height_);
  cv::dft(spectrum, spectrum, 0, height_);
  std::vector<std::vector<float>> scores;
  std::vector<double> angles;
  for (std::size_t k = 0; k < spectra_.size(); k += every) {
    scores.push_back(ScoreAngle(padded, k));
    angles.push_back(static_cast<double>(k) * step_rad_);
  }
  // At each place the best of all angles.
  std::vector<float> best = scores.front();
  for (std::size_t k = 1; k < scores.size(); ++k) {
    for (std::size_t i = 0; i < best.size(); ++i) {
      best[i] = std::max(best[i], scores[k][i]);
    }
  }
  // Of the short side: nearer maxima are one place. Not studied.
  constexpr double kMinApart = 0.15;
  // Share of the best score: angles that are nearly as good are kept, since the
  // path knows better. Not studied.
  constexpr float kNearlyBest = 0.97F;
  // Score of a place where nothing changes.
  constexpr float kNoScore = 1e-3F;
  const auto apart =
      static_cast<std::int32_t>(kMinApart * shape_.short_side) + 1;
  const auto at = [&](std::size_t k, std::int32_t x, std::int32_t y) {
    return static_cast<double>(
        scores[k][static_cast<std::size_t>(std::clamp(y, 0, height_ - 1)) *
                      static_cast<std::size_t>(width_) +
                  static_cast<std::size_t>(std::clamp(x, 0, width_ - 1))]);
  };
  std::vector<PlacedShape> found;
  for (std::size_t place = 0; place < most && found.size() < 2 * most;
       ++place) {
    const auto top = std::max_element(best.begin(), best.end());
    const float highest = *top;
    if (!(highest > kNoScore)) break;
    const auto index = static_cast<std::int32_t>(top - best.begin());
    const std::int32_t x = index % width_;
    const std::int32_t y = index / width_;
    for (std::size_t k = 0; k < scores.size() && found.size() < 2 * most; ++k) {
      const double here = at(k, x, y);
      if (here < static_cast<double>(kNearlyBest * highest)) continue;
      PlacedShape shape;
      shape.centre.x_px =
          x + TopOfParabola(at(k, x - 1, y), here, at(k, x + 1, y));
      shape.centre.y_px =
          y + TopOfParabola(at(k, x, y - 1), here, at(k, x, y + 1));
      shape.angle_rad = angles[k];
      if (scores.size() > 2) {
        const std::size_t n = scores.size();
        shape.angle_rad += static_cast<double>(every) * step_rad_ *
                           TopOfParabola(at((k + n - 1) % n, x, y), here,
                                         at((k + 1) % n, x, y));
      }
      shape.score = here;
      found.push_back(shape);
    }
    for (std::int32_t v = std::max(0, y - apart);
         v <= std::min(height_ - 1, y + apart); ++v) {
      for (std::int32_t u = std::max(0, x - apart);
           u <= std::min(width_ - 1, x + apart); ++u) {
        best[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
             static_cast<std::size_t>(u)] = -1.0F;
      }
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const PlacedShape& a, const PlacedShape& b) {
                     return a.score > b.score;
                   });
  return found;
}

}  // namespace touchdown::vision
