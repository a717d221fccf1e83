// How large what the budget leaves out can be, for one clip: each effect with
// the error of the approach angle that a plausible size of it makes, and where
// it would exceed the stated u.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "app/measure/analyze.h"

namespace touchdown::pipeline {

struct LeftOutSizes {
  // What a person who sets up by eye may miss by. Larger names larger errors;
  // from common practice with a tape and a square, not measured.
  double out_of_plane_rad = 2.0 * core::kDegree;
  double slope_rad = 1.0 * core::kDegree;
  // Outlines by light and gamma, px: recorded clips were off by up to this.
  double outline_px = 0.1;
  // Of the frame interval in which a rolling shutter reads the picture: the
  // worst there is.
  double readout = 1.0;
  // Of a body that the air may slow: as light as water. Lighter names larger
  // errors; wood has 500 to 900, steel 7800, a table-tennis ball 80.
  double density_kg_per_m3 = 1000.0;
  // From which error on a rolling shutter is worth a warning: half the default
  // margin of a verdict.
  double warn_rad = 0.5 * core::kDegree;
};

// An effect in numbers.
struct LeftOutEffect {
  std::string name;      // "path out of the plane"
  double error_rad = 0;  // of the approach angle, for the assumed size
  std::string text = {};
  bool warns = false;
};

// Nothing where no approach angle was measured. First order:
//   path, yaw  (r/f) sin(psi) + (1/cos(psi) - 1) sin(b) cos(b), r from the
//              picture's middle to the body at contact, f the focal length, or
//              the picture's width where no lens is calibrated
//   rolling    (v_y / H) readout sin(b) cos(b), v_y in px a frame; of clips
//   that
//              are no camera's raw data
//   slope      g sin(s) T / (2 v) sin(b), T the flight that was seen
//   outline    none: all of the path moves; contact time and gaps do
//   drag       none: of the speed k s / 2, s the path to the contact, k = 3 c_D
//              rho / (4 d rho_body) of a sphere of diameter d (drag.h)
std::vector<LeftOutEffect> LeftOutEffects(const Analysis& analysis,
                                          const LeftOutSizes& sizes = {});

// The probability that the air bends the flights, by Bayes' theorem: exp(z^2/2)
// to 1000, z standard deviations of the drag that they show. 1000: what is
// rarely seen (1 in 100) times what a further parameter takes up of noise.
// Larger: flights in air are fitted as if there were none; smaller widens u of
// clips without drag. 0.5 at z = 3.7. 0 where it is not told.
double ProbabilityOfDrag(const vision::ContactResult& contacts);

// Says what the flights show of drag, and what that of a light body would do.
// May be called again.
void DescribeDrag(Analysis& analysis, const LeftOutSizes& sizes = {});

// Puts them into the model of the scene, and what warns among the warnings.
void DescribeLeftOut(Analysis& analysis, const LeftOutSizes& sizes = {});

}  // namespace touchdown::pipeline
