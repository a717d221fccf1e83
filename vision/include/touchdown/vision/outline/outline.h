// The body's outline in one frame, to sub-pixel: its image is fitted itself.
//
// Model of a pixel at p:   I(p) = (1 - c(p)) out(p) + c(p) in(p)
//   c     coverage of the pixel by the body, blurred by a Gaussian of standard
//         deviation w (optics, pixel, focus): for a disc of radius R at
//         distance r from its centre  Phi(z) to third order in w/R
//         (src/outline/outline_image.h; to first order
//         Phi((R - w^2/(2 R) - r)/w)); for a rectangle the product of two
//         slabs, exact for a Gaussian blur
//   out   the known background, or a quadratic polynomial where the body never
//         leaves it uncovered
//   in    a quadratic polynomial over the body (shading)
// While the shutter is open the body moves by open * travel and turns by open *
// turn, and the coverage is the mean along that way. Gauss-Newton on all
// parameters with the clip's own noise as weights, and robust (Tukey) weights
// against spots, shadows and other things that move. The covariance is that of
// the normal equations: at the Cramer-Rao bound where the model holds, widened
// by the residuals' excess where it does not.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "touchdown/calib/plane.h"
#include "touchdown/core/expected.h"
#include "touchdown/core/frame.h"
#include "touchdown/core/words.h"
#include "touchdown/vision/background/background.h"

namespace touchdown::vision {

struct Hider;

// Geometry of the outline in the image.
struct Outline {
  core::BodyKind kind = core::BodyKind::kSphere;
  core::PixelPoint centre;
  double radius_px = 0.0;      // sphere
  double half_long_px = 0.0;   // rectangle
  double half_short_px = 0.0;  //
  double angle_rad = 0.0;      // of the long side, +x towards +y (image)
};

// The interior's polynomial over the body, in DN: value and standard
// uncertainty of each coefficient of 1, x, y, x^2, xy, y^2, where x and y are
// the position from the centre over the radius, or over the half sides along
// them.
struct Shading {
  std::array<double, 6> level{};
  std::array<double, 6> u{};
};

// What the body looks like beyond its shading (src/outline/appearance.h).
struct Appearance;

struct OutlineOptions {
  // What lies around the body: the known background, or, where the body never
  // left it uncovered, a polynomial of its own.
  enum class Surround { kBackground, kPolynomial };
  Surround surround = Surround::kBackground;

  bool fit_size = true;  // false: radius or sides are held as given
  // With all that frames share held: OutlineFit::shared is told, and sizes that
  // are one step of Gauss and Newton from the held ones.
  bool tell_shared = false;
  double blur_px = 0.8;  // start value of w, px
  bool fit_blur = true;

  // The centre's way in one frame interval, px, how far the body turns in it,
  // and the share of the interval in which the shutter is open, 0 to 1.
  core::PixelPoint travel_px{0.0, 0.0};
  double turn_rad = 0.0;
  double open = 0.0;
  bool fit_open = false;

  // How the body is shaded, where other frames tell: a prior of the interior.
  // Without it the shading of a small or blurred body costs half of the
  // centre's information.
  std::optional<Shading> shading;

  // What is to be added to the shading at each place of the body, where other
  // frames tell, or nothing; known background only. Not owned.
  const Appearance* appearance = nullptr;

  // Pixels lower than this above the ground line are left out, or modelled: the
  // blurred edges of body and ground do not superpose, as the body hides the
  // sharp one. 2 px: beyond the blur of both (else angles were off by two to
  // five standard uncertainties).
  std::optional<calib::GroundLine> ground;
  double ground_margin_px = 2.0;
  // kModelled: I = out + c (in - behind), `behind` being the background just
  // above the ground's blurred edge. Exact as long as the body is above the
  // line and all else stays as it is: no shadow, no reflection, an even edge.
  // Of a body that comes in flat it is the lower half in nearly every frame.
  enum class NearGround { kLeftOut, kModelled };
  NearGround near_ground = NearGround::kLeftOut;

  // What stands before the body (src/outline/hider.h), and leaves the fit; the
  // caller keeps it alive.
  const Hider* hider = nullptr;

  // The start is of an outline that was fitted, or between such: within a tenth
  // of a pixel or so. With `shading` known, too, what does not fit is an
  // outlier from the first round on, if most pixels do fit.
  bool starts_near = false;

  int max_iterations = 30;
  // Converged when no geometric parameter moves by more than this, px: a
  // twentieth of the best uncertainty that pixels give. With starts_near also
  // when by the last two rounds the next would move it by less than a fifth.
  double tolerance_px = 1e-4;
};

// What one frame says of what all frames share, at its held values: information
// and gradient (1/px^2, 1/px) of the size, the other side, the blur, and the
// share of the interval that is exposed (1), all else of the frame eliminated.
// Rows of what the body does not have, or the picture does not show, are 0.
struct SharedTerms {
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
};

struct OutlineFit {
  Outline outline;
  double blur_px = 0.0;
  double u_blur_px = 0.0;
  double open = 0.0;
  double u_open = 0.0;             // 0: held
  std::optional<Shading> shading;  // nothing where one level was fitted
  double u_x_px = 0.0;
  double u_y_px = 0.0;
  double correlation_xy = 0.0;
  double u_size_px = 0.0;        // radius, or half the long side
  double u_size_short_px = 0.0;  // half the short side
  double u_angle_rad = 0.0;
  double contrast_dn = 0.0;  // mean of in - out along the outline
  double misfit = 0.0;       // rms residual over expected noise
  double inliers = 0.0;      // share of pixels with more than half weight
  double visible = 1.0;  // share of the outline inside the picture and above
                         // the ground's margin
  double hidden = 0.0;   // share of it behind what the body does not explain
  int pixels = 0;
  // Of them lower than the ground's margin, and the mean square of their
  // residuals over that of the others: about 1 where they are as modelled.
  int pixels_near_ground = 0;
  double excess_near_ground = 0.0;
  int iterations = 0;
  std::optional<SharedTerms> shared;  // where it was asked for
};

// Fits the outline to `frame` from `start`, which must be within about a
// quarter of the body's size. Absent, with the reason, where there is no such
// outline: too little contrast, no convergence, less than a third of the
// outline visible.
core::Expected<OutlineFit> FitOutline(const core::Frame& frame,
                                      const Background& background,
                                      const Outline& start,
                                      const OutlineOptions& options = {});

// Distance of a point from the outline, positive inside, px.
double SignedDepth(const Outline& outline, double x_px, double y_px);

// Height of the centre above the lowest point of the outline, measured along
// the normal of a ground line at `ground_angle_rad` in the image: R for a
// sphere, a |sin| + b |cos| for a rectangle of half sides a, b.
double SupportHeight(const Outline& outline, double ground_angle_rad);

}  // namespace touchdown::vision
