// One frame as two layers: a picture that stands still, and before it the
// body's own picture, which moves and turns with it (J. Y. A. Wang and E. H.
// Adelson, IEEE Trans. Image Process. 3(5), 1994; N. Jojic and B. J. Frey, CVPR
// 2001).
//
//   I(x) = B(x) + sum_k w_k [ M(l_k) (T(l_k) + S(x - c_k) - B(x))
//                             + s^2 grad M . grad (T + S - B) - P(l_k) ]
//   l_k = R(phi_k)' (x - c_k),  pose_k = pose + v tau_k e
//
// B  still picture            T  the body's picture (body_picture.h)
// M  coverage of blur s (shape_cover.h)
// S  shading that stays with the light: a slope over the body
// w_k, tau_k  Gauss-Legendre nodes of the exposure, the share e of a frame
//    interval; v  the pose's change in one interval
// The camera blurs the product of the layers, not the layers: for a Gaussian
// G * (m t) = M T + s^2 grad M . grad T + ... (Mehler's series), T and M being
// the blurred ones. A shaded body would else be s^2 |grad T| / contrast off,
// hundredths of a pixel.
// P  the same for an edge of B, exactly (edge_product.h), in place of its
//    gradient: where a body lies on the ground's edge it is a tenth of a pixel
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "layers/body_picture.h"
#include "layers/edge_product.h"
#include "layers/picture_stack.h"
#include "layers/shape_cover.h"

namespace touchdown::vision::layers {

// In px of the stack's pictures; angle from +x to +y.
struct LayerPose {
  double x = 0.0;
  double y = 0.0;
  double angle_rad = 0.0;
};

inline constexpr std::size_t kPose = 3;     // x, y, angle
inline constexpr std::size_t kTerms = 6;    // of a quadratic: 1 x y xx xy yy
inline constexpr std::size_t kShared = 12;  // what the frames share, see below

// What T has beside a quadratic, as a Gaussian Markov random field of Matern's
// class on the grid of T's coefficients (F. Lindgren, H. Rue and J. Lindstrom,
// J. R. Stat. Soc. B 73(4), 2011, alpha = 2): with the Laplacian L of the grid
// its precision is
//   Q = (kappa^2 + L)^2 / tau^2,
// its autocorrelation kappa d K_1(kappa d) at d px; white where kappa is large.
struct Texture {
  double deviation_dn = 0.0;  // standard deviation, which tau follows from
  double rate = 1.0;          // kappa, per px
};

// What all frames have in common.
struct Layers {
  Shape shape;
  double blur = 1.0;      // s, px
  double exposure = 0.3;  // e, of a frame interval; kLeastExposure or more
  double slope_x = 0.0;   // S: DN across the body's reach
  double slope_y = 0.0;

  // T: a quadratic in x and y over the body's reach where the body is flat
  // (most are: then no picture is learned, which is ten times faster), else a
  // spline.
  bool flat = true;
  std::array<double, kTerms> quadratic{};
  PictureGrid grid;
  std::vector<float> picture;  // T's coefficients
  std::vector<float> still;    // B
  // What B and T are worth: sums of squared coverage, as if so many frames
  // showed a pixel alone.
  std::vector<float> still_weight;
  std::vector<float> picture_weight;
  // B's edges, as each pixel sees them (still_edges.h); empty: none.
  std::vector<StillEdge> edges;

  double noise_dn = 2.0;  // of a pixel
  Texture texture;
};

// Of a frame interval. At 5 px a frame it blurs by 0.07 px, which no picture
// tells from less; at 0 the frame has no derivative by it.
inline constexpr double kLeastExposure = 0.05;

// Of the noise: less over two pixels of B is no edge.
inline constexpr double kLeastStillStep = 2.0;

// A step of no more than `most` to either side.
inline double Limited(double value, double most) {
  return std::clamp(value, -most, most);
}

// The order of the shared parameters in the derivatives.
enum SharedParameter : std::size_t {
  kBlur,
  kExposureSquare,  // e^2, which the frame is linear in where e is small
  kLong,
  kShort,
  kSlopeX,
  kSlopeY,
  kQuadratic  // the first of kTerms
};

// Derivatives by all parameters, or by those of the pose alone: then
// `by_shared` and `share` stay empty.
enum class Derivatives { kAll, kByPose };

// One frame's pixels that show something of the body: residuals and first
// derivatives.
struct FrameSamples {
  std::vector<std::int32_t> pixel;
  std::vector<float> level;     // I, DN
  std::vector<float> residual;  // I - model, DN
  std::vector<float> weight;    // robust, 0..1
  std::vector<float> open;      // 1 - M: derivative by B
  std::vector<float> cover;     // M
  std::array<std::vector<float>, kPose> by_pose;
  std::array<std::vector<float>, kShared> by_shared;
  // Derivatives by a spline T: `nodes` places a pixel, each with its share of
  // coverage. Of a flat body none; for two nodes of the exposure their middle.
  std::size_t nodes = 0;
  std::vector<SplinePlace> place;
  std::vector<float> share;

  std::size_t size() const { return pixel.size(); }
  void Resize(std::size_t count, Derivatives derivatives);
};

// A flat T as a spline.
void LearnTexture(Layers& layers);

// Cauchy's, at four standard deviations of noise.
inline float RobustWeight(float residual, double noise_dn) {
  // Standard deviations: less gives weight away, more lets an occluder pull.
  constexpr float kCut = 4.0F;
  const float off = residual / (kCut * static_cast<float>(noise_dn));
  return 1.0F / (1.0F + off * off);
}

// `motion`: v. Pixels that the body does not reach, or that lie outside of the
// picture's window, are left out. Takes the place of what `samples` held; its
// memory is used again.
void Linearize(const PictureStack& stack, std::size_t picture,
               const Layers& layers, const LayerPose& pose,
               const LayerPose& motion, Derivatives derivatives,
               FrameSamples& samples);

// The pose's change in one frame interval, from the poses beside it: of both
// sides, or of the steadier one where a blow lies between.
std::vector<LayerPose> EstimateMotions(const std::vector<LayerPose>& poses,
                                       const std::vector<std::int64_t>& frames);

}  // namespace touchdown::vision::layers
