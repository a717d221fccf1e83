// The noise of a track, judged by its own scatter.
#pragma once

#include <vector>

#include "contact/motion_segments.h"
#include "touchdown/vision/contact/flight.h"
#include "touchdown/vision/contact/plane_track.h"

namespace touchdown::vision {

// What poses scatter beyond what they claim: compression, texture and all that
// is no noise of single pixels. Standard deviations; 0 in a clean clip.
struct ExcessNoise {
  double height_px = 0.0;
  double face_rad = 0.0;
};

// Where third differences, blind to any parabola, exceed what the poses claim,
// the claims are widened. Differences of poses further apart see what
// neighbours have in common. The excess goes together over some frames, so that
// it counts kExcessVariance-fold.
ExcessNoise WidenToScatter(PlaneTrack& track);

// Factor on the variance of the excess. The mean of 11 poses before an impact
// was off by 0.45 of one pose's excess, as if 5 of them counted (11 / 5 = 2.2).
// Larger: u too wide in compressed clips; smaller: intervals that cover too
// little. Measured on 117 clips in H.264 and MJPEG of known truth.
inline constexpr double kExcessVariance = 2.2;

// By how much the u of a fit must grow whose residuals, in units of their own
// u, exceed it or go together: the square root of
//   max(1, chi^2 / (degrees of freedom) (1 + 2 sum_k rho_k))
// rho_k: the correlation k frames apart within a run of frames, and beside it
// the share of the degrees of freedom that the fit took, which it takes from
// slow errors; summed as long as it is positive (Geyer, Statist. Sci. 7, 1992,
// 473). Not only where it is beyond chance: with tens of frames chance reaches
// to 0.7, and a codec's errors do not. Of spins in H.264 (crf 23) 136 of 149
// then lie within 1.96 u for 130, in raw clips 140 of 149 for 138 of 148.
double ComputeInflation(const std::vector<std::vector<double>>& runs,
                        int degrees);

// Widens the claims of poses whose errors go together, so that fits of many
// frames do not gain by their number: of each coordinate by the
// inflation of the residuals of all flights (ComputeInflation). Whether any was
// widened.
bool WidenToCorrelation(const std::vector<Stretch>& stretches,
                        const FlightOptions& options, PlaneTrack& track);

}  // namespace touchdown::vision
