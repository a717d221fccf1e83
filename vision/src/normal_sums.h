// The sums of weighted least squares, row by row.
#pragma once

#include <array>
#include <cstddef>

namespace touchdown::vision {

// Of up to kMost parameters: much of a fit's time goes here, so plain loops
// over the lower triangle, in fours (the rows are padded with zeros) that the
// compiler makes vectors of.
template <std::size_t kMost>
class NormalSums {
 public:
  static constexpr std::size_t kPadded = (kMost + 3) / 4 * 4;
  using Row = std::array<double, kPadded>;  // zero beyond the parameters

  void Clear() {
    sums_.fill(0.0);
    gradient_.fill(0.0);
  }
  // A row of n derivatives: weight * row row^T, weight * row * residual.
  void Add(const Row& row, std::size_t n, double weight, double residual) {
    for (std::size_t i = 0; i < n; ++i) {
      const double w = weight * row[i];
      if (w == 0.0) continue;
      gradient_[i] += w * residual;
      double* const sums = &sums_[i * kPadded];
      for (std::size_t j = 0; j <= i; j += 4) {
        sums[j] += w * row[j];
        sums[j + 1] += w * row[j + 1];
        sums[j + 2] += w * row[j + 2];
        sums[j + 3] += w * row[j + 3];
      }
    }
  }

  double at(std::size_t i, std::size_t j) const {  // j <= i
    return sums_[i * kPadded + j];
  }
  double gradient(std::size_t i) const { return gradient_[i]; }

 private:
  std::array<double, kMost * kPadded> sums_{};
  std::array<double, kMost> gradient_{};
};

}  // namespace touchdown::vision
