// Air drag in free flight, and what the flights themselves tell of it.
//
//   d(v_t)/dt = -k |v| v_t,   d(v_n)/dt = -k |v| v_n - g
//   k = c_D rho A / (2 m)                                         [1/px]
//
// (Landau and Lifshitz, Fluid Mechanics, section 45: turbulent drag, Reynolds
// numbers from some 1e3 on; c_D 0.4 to 0.5 of a sphere up to 2e5.) k times a
// path is the share of the speed that is lost on it. A sphere of 40 mm has k =
// 0.011/m at the density of water and 0.13/m as a table-tennis ball. A parabola
// that is fitted to a long flight in air is too slow at both of its ends.
#pragma once

#include <optional>
#include <span>

#include "touchdown/core/estimate.h"
#include "touchdown/vision/contact/flight.h"
#include "touchdown/vision/contact/plane_track.h"

namespace touchdown::vision {

// How a body is off the parabola that shares its state at t = 0.
struct DragOffset {
  double along_px = 0.0;
  double height_px = 0.0;
  double v_t = 0.0;  // px per unit of time
  double v_n = 0.0;
};

// t after the state (v_t, v_n), or before it where t < 0, under `gravity`
// downward. Any unit of time. Runge and Kutta's steps of fourth order: to 1e-4
// of the offset where k times the path is below 0.25.
DragOffset ComputeDragOffset(double v_t, double v_n, double gravity,
                             double drag_per_px, double t);

// k as these flights have it, under the gravity of the options; where that is
// not known, by the difference between rise and fall. Gauss and Newton's steps,
// all flights together, each weighted by its own residuals and their
// correlation; u grows where the flights disagree. Nothing where no flight has
// eight frames. It may be negative, by noise.
std::optional<core::Estimate> FitDrag(const PlaneTrack& track,
                                      std::span<const SampleRange> flights,
                                      const FlightOptions& options = {});

}  // namespace touchdown::vision
