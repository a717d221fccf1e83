// Edges of the still picture, such as the ground's, as each pixel sees them.
//
// Three pixels across an edge tell its contrast and where it lies
// (edge_product.h). But a body's edge that lies on it, as that of a body on the
// ground, is at a kink of the product: what the place is off by, to either
// side, makes the product smaller, and noise and texture lift the body by
// hundredths of a pixel. A straight edge is seen by many pixels: its place is
// that of a line of least squares through all that were seen without the body.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "layers/edge_product.h"

namespace touchdown::vision::layers {

// v = at_zero + slope u; u: column and v: row, or the other way round.
struct StillLine {
  bool along_rows = true;  // u is the column
  bool rises = true;       // levels rise with v
  std::int32_t begin = 0;  // u, of the first and the last pixel
  std::int32_t end = 0;
  double at_zero = 0.0;
  double slope = 0.0;

  double At(double u) const { return at_zero + slope * u; }
  // In the coordinates of a part of the picture whose first pixel is (x, y).
  StillLine Within(std::int32_t x, std::int32_t y) const;
};

struct StillPicture {
  const float* levels = nullptr;  // B, DN, row by row
  // How often a pixel was seen without the body; empty: all as often.
  std::span<const float> clear;
  std::int32_t width = 0;
  std::int32_t height = 0;
};

// The straight edges. `blur`: of all edges, px; `least_dn`: steps over two
// pixels that are smaller are no edges.
std::vector<StillLine> FindStillLines(const StillPicture& still, double blur,
                                      double least_dn);

// The edge that each pixel sees; none at the picture's border. Along `lines`
// the contrast is that of the levels across them.
std::vector<StillEdge> FindStillEdges(const StillPicture& still,
                                      std::span<const StillLine> lines,
                                      double blur, double least_dn);

}  // namespace touchdown::vision::layers
