// Free flight: the centre's motion between contacts.
//
//   along(t)  = s0 + v_t (t - t0)                                  [px]
//   height(t) = h0 + v_n (t - t0) - g (t - t0)^2 / 2               [px]
//   face(t)   = f0 + w (t - t0)                 rectangles only    [rad]
//
// by weighted least squares. Gravity is a parameter with a prior: known where
// the scale is (its uncertainty that of the scale and of local gravity), free
// where not; so one fit serves both, and its covariance carries what is not
// known. Where the air slows the body, the coefficients are those at t0, and
// what drag does to the path until t is added (drag.h).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "touchdown/core/estimate.h"
#include "touchdown/vision/contact/plane_track.h"

namespace touchdown::vision {

struct FlightOptions {
  // Gravity along the ground's normal, px/s^2; nothing: free.
  std::optional<core::Estimate> gravity_px_per_s2;
  // Of the speed, lost on a px of the path; 0: no air.
  double drag_per_px = 0.0;
};

// State at an instant, with the covariance of (height, v_n).
struct FlightState {
  double along_px = 0.0;
  double height_px = 0.0;
  double v_t = 0.0;  // px/s
  double v_n = 0.0;  // px/s, upward
  double face_rad = 0.0;
  double omega = 0.0;  // rad/s, d(face)/dt
  double u_along_px = 0.0;
  double u_height_px = 0.0;
  double u_v_t = 0.0;
  double u_v_n = 0.0;
  double covariance_h_vn = 0.0;
  double u_face_rad = 0.0;
  double u_omega = 0.0;
};

struct Flight {
  double t0_s = 0.0;           // reference time: the middle of the frames
  Eigen::Vector2d along;       // s0, v_t
  Eigen::Vector3d height;      // h0, v_n, g
  double drag_per_px = 0.0;    // FlightOptions'
  Eigen::Vector2d face;        // f0, omega
  Eigen::Matrix2d along_cov;   //
  Eigen::Matrix3d height_cov;  //
  Eigen::Matrix2d face_cov;    //
  int frames = 0;
  std::int64_t first_frame = 0;
  std::int64_t last_frame = 0;
  // Residuals over the poses' stated uncertainty, per degree of freedom; the
  // covariances are widened by them where above 1.
  double reduced_chi2 = 1.0;
  double rms_px = 0.0;

  FlightState At(double time_s) const;
};

// Fits `samples` (>= 2 frames with a gravity prior, >= 3 without; else
// std::invalid_argument).
Flight FitFlight(std::span<const PlaneSample> samples,
                 const FlightOptions& options = {});

// Gravity as the flights themselves have it, px/s^2: fitted freely to each of
// these ranges, under this drag, and pooled by weight. Nothing where none of
// them has six frames: three determine a parabola, and so few do not judge it.
std::optional<core::Estimate> FitGravity(const PlaneTrack& track,
                                         std::span<const SampleRange> flights,
                                         double drag_per_px = 0.0);

}  // namespace touchdown::vision
