// Straight edges of a still picture that could be the ground line, each with
// its uncertainty. Which of them the body really lands on only its track can
// tell: a visible edge need not be the contact line.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "touchdown/calib/lens.h"
#include "touchdown/calib/plane.h"

namespace touchdown::calib {

// A still gray picture, row-major, in DN; the caller keeps it alive.
struct StillImage {
  const float* level = nullptr;
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  double noise_dn = 1.0;  // standard deviation of a pixel of this picture
};

struct GroundLineOptions {
  // Steeper lines are walls, not ground. 20 degrees: a rolled camera, no ramp.
  double most_tilt_rad = 0.35;
  // A line must be seen in this share of the picture's columns. A third: the
  // body, a post or a shadow may hide the rest.
  double least_share = 0.33;
  // Its step in level must exceed this many times the noise.
  double least_contrast_sigmas = 4.0;
  int most_lines = 4;
  // Where it is given, edges are found in the picture and fitted in the lens's
  // ideal picture, in which straight lines are straight: the result is there,
  // too.
  std::optional<Lens> lens;
  int threads = 1;  // 0: one for each core; results do not depend on it
};

// Lines by falling support. Each is a robust straight line through the edge's
// position in every column (least squares of a Gaussian-blurred step, with its
// own two levels in each column); u from the scatter about the line, widened by
// the scatter's correlation along it (texture of the ground is smoothed by the
// lens: neighbouring columns err alike). Where one side is textured by more
// than noise, the direction comes from the edge's foot on the plain side
// (generalised least squares, src/edge_texture.h). An edge that goes up and
// down evenly (tiles, a corrugated sheet) is fitted with its wave; the line is
// its middle.
std::vector<GroundLine> FindGroundLines(const StillImage& image,
                                        const GroundLineOptions& options = {});

}  // namespace touchdown::calib
