// Spots on a smoothly shaded face:
//   m(p) = q(p) + sum_k A_k exp(-(p - p_k)' S_k (p - p_k) / 2)
// with a quadratic q of the place over a size, and up to three spots, bright or
// dark.
#pragma once

#include <optional>
#include <span>

#include "numbers/symmetric_factor.h"

namespace touchdown::vision {

struct SpotModel {
  // Parameters of the shading and of one spot; spots at most (more are learnt
  // from noise; not studied); parameters at most.
  static constexpr int kShading = 6;  // of q: 1, x, y, x^2, xy, y^2
  static constexpr int kSpot = 6;     // A, x, y, Sxx, Sxy, Syy
  static constexpr int kMostSpots = 3;
  static constexpr int kMaxSpotParameters = kShading + kMostSpots * kSpot;
  static_assert(kMaxSpotParameters <= kMostUnknowns);

  double size_px = 1.0;
  int spots = 0;
  NormalVector parameters =
      NormalVector::Zero(kShading);  // q, then the spots; DN and px
  NormalMatrix covariance = NormalMatrix::Zero(kShading, kShading);
  double chi2 = 0.0;  // robust mean square of the residuals over the noise's

  // The value, DN, and its derivatives by the parameters if `by` is not null.
  double At(double x_px, double y_px, NormalVector* by) const;
};

// What was seen at a place.
struct SpotSample {
  double x_px = 0.0;
  double y_px = 0.0;
  double level_dn = 0.0;
  double variance_dn2 = 1.0;
};

struct SpotOptions {
  double size_px = 1.0;   // of q's places
  double reach_px = 1.0;  // spots lie no farther out, and are no wider
  double least_px = 0.5;  // nothing is narrower than the blur
  bool curved = true;     // false: q is linear
};

// Finds the spots by `cells`, means of many samples in small patches, and fits
// them to `samples`: one by one where the squares' sum falls by more than
// chance, robustly (Huber). Nothing where there is none.
std::optional<SpotModel> FindSpots(std::span<const SpotSample> cells,
                                   std::span<const SpotSample> samples,
                                   const SpotOptions& options);

}  // namespace touchdown::vision
