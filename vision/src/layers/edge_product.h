// What a camera sees where the body's edge lies on an edge of the still
// picture, such as that of the ground: the product of two layers, blurred, is
// not the product of the blurred ones.
//
// Two straight steps, m = [z1 > 0] and b = b0 + c [z2 > 0], with the angle
// between their normals of cosine rho, blurred by a Gaussian of standard
// deviation s (z1, z2: distances from the edges in units of s):
//   G * (m b) - (G * m) (G * b) = c (Phi2(z1, z2; rho) - Phi(z1) Phi(z2))
//     = c / (2 pi) int_0^asin(rho) exp(-(z1^2 - 2 z1 z2 sin t + z2^2)
//                                      / (2 cos^2 t)) dt
// (R. L. Plackett, Biometrika 41, 1954; the integral after A. Genz, Stat.
// Comput. 14, 2004, eq. 3.) Where both edges coincide it is c / 4 at their
// middle.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace touchdown::vision::layers {

// An edge of the still picture as one pixel sees it.
struct StillEdge {
  float contrast = 0.0F;  // c, DN; 0: there is none
  float z = 0.0F;         // z2: the pixel's distance, towards the higher level
  float normal_x = 0.0F;  // the direction in which levels rise
  float normal_y = 0.0F;
};

// Three neighbours, one pixel apart across an edge of one blur: by their
// curvature over their step, from -1 to 1, where they lie beside the edge, and
// what of the contrast their step is.
class EdgeTable {
 public:
  explicit EdgeTable(double blur);
  struct Place {
    float z = 0.0F;
    float share = 0.0F;
  };
  Place Look(float curvature) const;

 private:
  // Of the curvature from -1 to 1, and linear between them. Not studied.
  static constexpr std::size_t kCells = 128;
  std::array<float, kCells + 1> z_{};
  std::array<float, kCells + 1> share_{};
};

// Reads edges off a picture, all of one blur.
class StillEdges {
 public:
  // `least_dn`: steps over two pixels that are smaller are no edges.
  StillEdges(const float* still, std::int32_t width, double blur,
             double least_dn);
  // `pixel` is not at the picture's border.
  StillEdge FindEdge(std::int32_t pixel);

 private:
  const float* still_;
  std::int32_t width_;
  double blur_;
  float least_dn_;
  // Made when the first edge is met: in flight most windows show none, and the
  // table costs as much as a hundred pixels.
  std::optional<EdgeTable> table_;
};

// Phi2(z1, z2; rho) - Phi(z1) Phi(z2), to 1e-3.
float EdgeProduct(float z1, float z2, float rho);
// Its derivative by z1.
float EdgeProductSlope(float z1, float z2, float rho);

}  // namespace touchdown::vision::layers
