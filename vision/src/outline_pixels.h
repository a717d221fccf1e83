// The pixels that an outline is fitted to.
#pragma once

#include <optional>
#include <vector>

#include "touchdown/calib/plane.h"
#include "touchdown/core/frame.h"
#include "touchdown/vision/background.h"
#include "touchdown/vision/outline.h"

namespace touchdown::vision {

struct OutlinePixel {
  double x = 0.0;
  double y = 0.0;
  double value = 0.0;       // DN
  double background = 0.0;  // DN
  double variance = 1.0;    // DN^2
};

// What lies above the ground line by a margin, or everything without a line.
class UsableSide {
 public:
  UsableSide(const std::optional<calib::GroundLine>& ground, double margin_px);
  bool Holds(double x_px, double y_px) const {
    return x_ * x_px + y_ * y_px + offset_ >= 0.0;
  }

 private:
  double x_ = 0.0;
  double y_ = 0.0;
  double offset_ = 0.0;
};

// The body and a band around it that holds the blurred edge and some of what
// lies outside; of a large body only a band inside the edge, wide enough to
// tell the interior's level.
struct PixelBand {
  double margin_px = 0.0;         // outwards, and inwards where all counts
  double inner_px = 0.0;          // the greatest depth inside
  bool known_background = false;  // leave out where it is not known
};
void CollectOutlinePixels(const core::Frame& frame,
                          const Background& background, const Outline& outline,
                          double cosine, double sine, const UsableSide& usable,
                          const PixelBand& band,
                          std::vector<OutlinePixel>& pixels);

// Share of the outline that lies in the frame and on the usable side.
double VisibleShare(const core::Frame& frame, const Outline& outline,
                    double cosine, double sine, const UsableSide& usable);

double Extent(const Outline& outline);        // px, centre to farthest point
double SmallestHalf(const Outline& outline);  // px

}  // namespace touchdown::vision
