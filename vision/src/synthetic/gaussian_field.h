// Textures: Gaussian random fields of a stated correlation.
#pragma once

#include <cstdint>
#include <vector>

namespace touchdown::vision {

// Variance 1 and autocorrelation exp(-d^2 / (2 l^2)) with l = correlation_px
// (0: independent pixels), row-major. White noise is blurred along rows and
// then along columns; the same seed gives the same field.
std::vector<float> GaussianField(int width, int height, double correlation_px,
                                 std::uint64_t seed);

}  // namespace touchdown::vision
