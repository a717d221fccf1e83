// An edge of textured ground: gravel, wood, a scratched plate.
//
// The texture ends where the ground does: near the edge a column is
//   v(y) = a + (g - a) F + t(y) F + noise,   F = Phi((y - y_edge) / blur)
// with a correlated texture t. In the edge's foot, where F is small, there is
// little of it and much of the step's rise over the noise. Least squares with
// the covariance  s^2 1 + tau^2 rho(|i - j|) F_i F_j  (generalised, Aitken)
// take it from there; with equal weights a column errs by the texture's share
// of the step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "edge_wave.h"
#include "touchdown/calib/ground_lines.h"

namespace touchdown::calib {

inline double PixelLevel(const StillImage& image, std::int32_t x,
                         std::int32_t y) {
  return static_cast<double>(
      image.level[static_cast<std::size_t>(y) *
                      static_cast<std::size_t>(image.width_px) +
                  static_cast<std::size_t>(x)]);
}

struct EdgeTexture {
  bool below = true;          // side of the edge that is textured
  double variance_dn2 = 0.0;  // of the other side: noise
  // Of the texture beyond that noise, at distances of 0, 1, 2 ... rows.
  std::vector<double> covariance_dn2;
  std::vector<double> ground_dn;  // level of the textured side, by column
};

// What lies beside an edge that is seen at `edge_px[x]` in column x, beyond
// `reach_px`. Nothing where neither side varies by more than the other does
// (in variance, twice), or where the picture has no room for such strips.
std::optional<EdgeTexture> LearnTexture(const StillImage& image,
                                        const std::vector<double>& edge_px,
                                        double reach_px);

// The edge's position in column x near y0 (px): Gauss and Newton in position
// and in the plain side's level. strength is 0 where there is none.
EdgePoint TexturedEdge(const StillImage& image, const EdgeTexture& texture,
                       std::int32_t x, double y0, double blur_px);

}  // namespace touchdown::calib
