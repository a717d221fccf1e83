// How much of a pixel a blurred shape covers, and its derivatives.
//
// Rectangle of half sides a, b with its centre at the origin, blurred by a
// Gaussian of standard deviation s (the edge's blur and the pixel's own width,
// s^2 = psf^2 + 1/12):
//   M = A(x; a) A(y; b),  A(u; h) = Phi((h - u) / s) + Phi((h + u) / s) - 1
// Disc of radius a:
//   M = Phi((a - |p|) / s - s / (2 a))
// to first order in s / a: blur draws a curved edge inward by s^2 / (2 a), as
// heat does (the mean of Rice's distribution is |p| + s^2 / (2 |p|)). For
// a >= 4 s it is 0.006 off at most; without the last term it were 0.05.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "layers/edge_product.h"

namespace touchdown::vision::layers {

struct Shape {
  bool disc = false;
  double half_long = 0.0;   // px; a disc's radius
  double half_short = 0.0;  // px; a disc's radius, too
  double Reach() const;     // from the centre to the farthest point
  double Area() const;
};

struct CoverAt {
  float value = 0.0F;
  float by_x = 0.0F;  // derivatives by the pixel's place in the body
  float by_y = 0.0F;
  float by_blur = 0.0F;
  float by_long = 0.0F;  // by the half sides; a disc's radius: by_long
  float by_short = 0.0F;
};

// Phi and its density from a table: 1e-6 off at most.
class NormalTable {
 public:
  // Standard deviations: beyond, Phi is within 3e-7 of 0 or 1.
  static constexpr float kReach = 5.0F;
  NormalTable();
  // Below -5 and above 5 the ends' values.
  void Look(float z, float& phi, float& density) const {
    const float at = (z + kReach) * kPerUnit;
    if (!(at > 0.0F)) {
      phi = 0.0F;
      density = 0.0F;
      return;
    }
    if (at >= static_cast<float>(kCells)) {
      phi = 1.0F;
      density = 0.0F;
      return;
    }
    const auto cell = static_cast<std::size_t>(at);
    const float share = at - static_cast<float>(cell);
    phi = phi_[cell] + share * (phi_[cell + 1] - phi_[cell]);
    density = density_[cell] + share * (density_[cell + 1] - density_[cell]);
  }

 private:
  // Cells a standard deviation, and in all: so many keep Phi within 1e-6.
  static constexpr float kPerUnit = 200.0F;
  static constexpr std::size_t kCells = 2000;
  std::array<float, kCells + 2> phi_{};
  std::array<float, kCells + 2> density_{};
};

// The product of the shape's edges with one of the still picture, DN.
struct Product {
  float value = 0.0F;
  float by_x = 0.0F;  // as in CoverAt
  float by_y = 0.0F;
};

// From one place in a row of pixels to another; empty where `to` is less.
struct RowPart {
  float from = 0.0F;
  float to = -1.0F;
};

// The coverage of pixels by one shape of one blur.
class ShapeCover {
 public:
  ShapeCover(const Shape& shape, double blur);
  CoverAt At(float x, float y) const {
    // Most pixels are far from the edges, which the table ends at.
    if (disc_) {
      const float square = x * x + y * y;
      if (square < inside_long_ * inside_long_) return {.value = 1.0F};
      if (square > outside_long_ * outside_long_) return {};
      return CoverOfDisc(x, y, square);
    }
    const float along = std::abs(x);
    const float across = std::abs(y);
    if (along < inside_long_ && across < inside_short_) return {.value = 1.0F};
    if (along > outside_long_ || across > outside_short_) return {};
    return CoverOfRectangle(x, y);
  }
  // Where a row that lies `down` px below the centre sees the shape, in px from
  // the centre: beyond, coverage is below 2e-4. `cosine`, `sine`: of the body's
  // direction.
  RowPart FindSeen(float down, float cosine, float sine) const;
  // `cosine`, `sine`: of the body's direction, in which x and y are.
  Product WithEdge(float x, float y, const StillEdge& edge, float cosine,
                   float sine) const;

 private:
  CoverAt CoverOfDisc(float x, float y, float square) const {
    CoverAt at;
    const float distance = std::sqrt(square) + 1e-6F;
    const float z = (half_long_ - distance) * per_blur_ - bend_;
    float density = 0.0F;
    table_.Look(z, at.value, density);
    const float slope = density * per_blur_;
    const float outward = slope / distance;
    at.by_x = -outward * x;
    at.by_y = -outward * y;
    at.by_long = slope * by_long_;
    at.by_blur = -slope * (z + 2.0F * bend_);
    return at;
  }
  CoverAt CoverOfRectangle(float x, float y) const;

  const NormalTable& table_;
  bool disc_;
  float half_long_;
  float half_short_;
  // Half sides, or radius: nearer all is covered, farther nothing.
  float inside_long_ = 0.0F;
  float inside_short_ = 0.0F;
  float outside_long_ = 0.0F;
  float outside_short_ = 0.0F;
  float per_blur_;
  float bend_;     // s / (2 a) of a disc
  float by_long_;  // of z by a disc's radius, in 1 / s
};

}  // namespace touchdown::vision::layers
