#include "synthetic/gaussian_field.h"

#include <cmath>
#include <cstddef>
#include <random>

#include "synthetic/gaussian.h"

namespace touchdown::vision {

std::vector<float> GaussianField(int width, int height, double correlation_px,
                                 std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  const GaussianSource gaussian;
  // White noise blurred by s has the autocorrelation exp(-d^2 / (4 s^2)).
  const double s = correlation_px / std::sqrt(2.0);
  const int reach = static_cast<int>(std::ceil(4.0 * s));
  std::vector<float> kernel;
  double squares = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    const double value = s > 0.0 ? std::exp(-0.5 * k * k / (s * s)) : 1.0;
    squares += value * value;
    kernel.push_back(static_cast<float>(value));
  }
  // Unit sum of squares: white noise of variance 1 keeps it.
  for (float& value : kernel) value /= static_cast<float>(std::sqrt(squares));

  const int wide = width + 2 * reach;
  const int high = height + 2 * reach;
  const auto size = [](int a, int b) {
    return static_cast<std::size_t>(a) * static_cast<std::size_t>(b);
  };
  std::vector<float> along(size(width, high), 0.0f);
  std::vector<float> white(static_cast<std::size_t>(wide));
  for (int y = 0; y < high; ++y) {
    for (float& value : white) value = gaussian(engine);
    float* row = along.data() + size(y, width);
    for (int k = 0; k <= 2 * reach; ++k) {
      const float weight = kernel[static_cast<std::size_t>(k)];
      const float* shifted = white.data() + k;
      for (int x = 0; x < width; ++x) row[x] += weight * shifted[x];
    }
  }
  std::vector<float> field(size(width, height), 0.0f);
  for (int y = 0; y < height; ++y) {
    float* out = field.data() + size(y, width);
    for (int k = 0; k <= 2 * reach; ++k) {
      const float weight = kernel[static_cast<std::size_t>(k)];
      const float* in = along.data() + size(y + k, width);
      for (int x = 0; x < width; ++x) out[x] += weight * in[x];
    }
  }
  return field;
}

}  // namespace touchdown::vision
