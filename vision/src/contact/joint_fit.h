// One contact and the two flights beside it, fitted together.
//
// Before touchdown at T and after release the centre flies freely; at T (and at
// the release) the body's lowest point is on the ground:
//   along(t)  = X + VX (t - T)
//   height(t) = ground(X) + S(FACE) + VY (t - T) - G (t - T)^2 / 2
//   face(t)   = FACE + OMEGA (t - T)
// with the velocities 2 after it, and what drag does until t (drag.h) added. An
// instant contact shares T, X and FACE between the flights; one that lasts has
// its own T2, X2, FACE2. A sphere has FACE and OMEGA where marks show how it
// turns, and S is its radius. Ground, sizes and gravity are parameters with
// priors, so that the covariance carries them and all that they have in common.
// Lengths in px, time in frames, relative to the start values: a far origin
// costs no digits.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <initializer_list>
#include <optional>
#include <span>

#include "touchdown/core/estimate.h"
#include "touchdown/vision/contact/flight.h"
#include "touchdown/vision/contact/plane_track.h"

namespace touchdown::vision {

enum JointParameter {
  kT,
  kX,
  kVx,
  kVy,
  kVx2,
  kVy2,
  kGround,  // height of the ground above the line, at the line's reference
  kSlope,   // of the ground to the line
  kHalfLong,
  kHalfShort,
  kFace,
  kOmega,
  kOmega2,
  kGravity,
  kT2,
  kX2,
  kFace2,
  kGravity2,
  kJointParameters
};

using JointVector = Eigen::Matrix<double, kJointParameters, 1>;
using JointMatrix = Eigen::Matrix<double, kJointParameters, kJointParameters>;

struct JointInput {
  std::span<const PlaneSample> before;
  std::span<const PlaneSample> after;  // empty: it stays down
  bool instant = true;
  double touchdown_s = 0.0;  // start values
  double release_s = 0.0;
  core::Estimate ground_px;  // prior, at the contact
  double u_slope_rad = 0.0;
  double reference_along_px = 0.0;  // where the line's height is known best
  // px/s^2; nothing: free, and another after than before, since without a scale
  // nothing says that the body keeps its distance from the camera.
  std::optional<core::Estimate> gravity_px_per_s2;
  double drag_per_px = 0.0;  // FlightOptions'
};

struct JointFit {
  JointVector p;           // px and frames
  JointMatrix covariance;  // widened where the residuals exceed the poses' u
  JointMatrix information;
  Eigen::Array<bool, kJointParameters, 1> active;
  bool instant = true;
  double origin_s = 0.0;   // T = 0 lies here
  double origin_px = 0.0;  // X = 0 lies here
  double reference_px = 0.0;
  double interval_s = 0.0;
  double drag_per_px = 0.0;
  bool sphere = false;  // its support does not hang on its attitude
  bool turns = false;   // attitude and spin are parameters
  double chi2 = 0.0;
  int degrees = 0;

  using Function = std::function<double(const JointVector&)>;
  // A function of the parameters with its uncertainty, first order.
  core::Estimate EstimateFunction(const Function& f) const;
  // The part of the uncertainty of `f` that would vanish if these were known.
  double UncertaintyShare(const Function& f,
                          std::initializer_list<JointParameter> known) const;

  double ToSeconds(double t) const { return origin_s + t * interval_s; }
  // Of the ground above the line, where parameters `q` put the contact.
  double GroundAtContact(const JointVector& q) const {
    return q[kGround] + q[kSlope] * (q[kX] - reference_px);
  }
  // Of the lowest point above the ground, t frames after the origin, in the
  // flight after release; 0 at the release itself.
  double ReboundGap(const JointVector& q, double t) const;
  // The flights as the rest of vision knows them; covariances included.
  Flight IncomingFlight(std::span<const PlaneSample> samples) const;
  Flight OutgoingFlight(std::span<const PlaneSample> samples) const;
};

// Standard deviations of a denominator: a quotient is absent below it, since
// the first-order u of a quotient holds only where the denominator is far from
// zero. At 5 the neglected second order is 4 % of the value. Not studied.
inline constexpr double kMeasurable = 5.0;

// Nothing where it does not converge or the frames do not determine it.
std::optional<JointFit> FitJointly(const PlaneTrack& track,
                                   const JointInput& input);

}  // namespace touchdown::vision
