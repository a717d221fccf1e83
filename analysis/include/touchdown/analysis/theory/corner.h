// Geometry and inertia of a body that touches the ground with one point: the
// words that contact.h, flat_contact.h and impact.h share.
//
//   leading corner (the body moves to +x,     trailing corner (the body moves
//   to P is ahead of C, slip = +1)               -x, P is behind C, slip = -1)
//
//            C o ___                                  C o ___
//   move -->    \   alpha                  <-- move      \   alpha
//                \ )                                      \ )
//     ~~~~~~~~~~~ P ~~~~~~~~~ -> x             ~~~~~~~~~~~ P ~~~~~~~~~ -> x
//      friction on P: <--  -mu F_n              friction on P: -->  +mu F_n
//
// C is the centre of mass, P the contact point, r = P - C = R (cos alpha,
// -sin alpha): x is laid so that P lies at +x of C, and alpha, the paper's
// radius angle, grows clockwise. slip = sign of P's velocity along x.
// The paper prints the trailing corner's sign, F_t = +mu F_n, without saying
// so; a body thrown nose-up lands on it, one thrown nose-down on the other.
//
// Matrix of inverse inertia seen by P (Delassus matrix), times the mass m:
//   G_NN = 1 + kappa cos^2,  G_NT = kappa sin cos,  G_TT = 1 + kappa sin^2
// with kappa = R^2/k^2, k the radius of gyration. det G = 1 + kappa.
#pragma once

namespace touchdown::analysis {

// Direction in which the contact point slides; the value is its sign.
enum class Slip : int { kTrailing = -1, kNone = 0, kLeading = 1 };

constexpr int Sign(Slip slip) { return static_cast<int>(slip); }

// Slip of a point that moves at `tangential_mps` along x.
constexpr Slip ClassifySlip(double tangential_mps) {
  if (tangential_mps > 0.0) return Slip::kLeading;
  return tangential_mps < 0.0 ? Slip::kTrailing : Slip::kNone;
}

// How mass lies about the centre. R is the distance from the centre of mass to
// the contact point: half a rectangle's diagonal, or the radius.
enum class MassLayout { kRectangle, kHoop, kShell, kSolidSphere };

// kappa = R^2/k^2: 3 for every uniform rectangle, (a^2+b^2)/4 over
// (a^2+b^2)/12; 1 for a hoop, which is what the paper calls a sphere; 3/2 for a
// thin spherical shell; 5/2 for a solid sphere.
constexpr double Kappa(MassLayout layout) {
  switch (layout) {
    case MassLayout::kHoop:
      return 1.0;
    case MassLayout::kShell:
      return 1.5;
    case MassLayout::kSolidSphere:
      return 2.5;
    case MassLayout::kRectangle:
      break;
  }
  return 3.0;
}

// Sine and cosine of alpha. `*_low` is what rounding to double took away, so
// that sin + sin_low has 64 bits; with it a sign lost in the noise of double
// can be certified (contact.h). `has_low` is false where nobody computed it.
struct SinCos {
  double sin = 0.0;
  double cos = 1.0;
  double sin_low = 0.0;
  double cos_low = 0.0;
  bool has_low = false;
};

// With low parts. Degrees are reduced exactly: 0, 30, 90, 180 deg give exact
// values, whereas 90 deg as a double in radians has cos = 6.1e-17, which
// matters when kappa is large. Throw std::invalid_argument unless the angle is
// finite.
SinCos SinCosOfRadians(double alpha_rad);
SinCos SinCosOfDegrees(double alpha_deg);

// Without low parts, for maps of many angles: three times as fast.
SinCos RoundedSinCosOfRadians(double alpha_rad);

// The Delassus matrix times m, dimensionless.
struct Delassus {
  double nn = 1.0;
  double nt = 0.0;
  double tt = 1.0;
};
Delassus ComputeDelassus(const SinCos& alpha, double kappa);

// Normal response to the normal force while sliding, times m:
//   A_hat = G_NN - slip mu G_NT = 1 + kappa cos (cos - slip mu sin)
// The paper's Eq. (6) lacks kappa and holds for slip = -1, kappa = 1 alone.
// Evaluated with fused multiply-adds that carry the rounding error of the
// product; error <= 2 u (1 + kappa cos^2 + kappa mu |sin cos|), u = 2^-53.
double SlidingResponse(const SinCos& alpha, double kappa, double mu, Slip slip);

}  // namespace touchdown::analysis
