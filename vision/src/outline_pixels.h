// The pixels that an outline is fitted to.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "outline_sums.h"
#include "touchdown/calib/plane.h"
#include "touchdown/core/frame.h"
#include "touchdown/core/points.h"
#include "touchdown/vision/background.h"
#include "touchdown/vision/outline.h"

namespace touchdown::vision {

// What lies above the ground line by a margin, or everything without a line,
// and is not set aside.
class UsablePart {
 public:
  UsablePart(const std::optional<calib::GroundLine>& ground, double margin_px);
  bool Holds(double x_px, double y_px) const {
    return x_ * x_px + y_ * y_px + offset_ >= 0.0 &&
           (aside_.empty() || !IsAside(x_px, y_px));
  }
  // Sets these pixels aside, and all within `reach_px` of any of them.
  void Without(const std::vector<core::PixelPoint>& pixels, double reach_px);

 private:
  bool IsAside(double x_px, double y_px) const;

  double x_ = 0.0;
  double y_ = 0.0;
  double offset_ = 0.0;
  core::PixelRect box_;  // of the pixels set aside
  std::vector<std::uint8_t> aside_;
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
                          double cosine, double sine, const UsablePart& usable,
                          const PixelBand& band, OutlinePixels& pixels);

// Share of the outline that lies in the frame and is usable.
double VisibleShare(const core::Frame& frame, const Outline& outline,
                    double cosine, double sine, const UsablePart& usable);

// Whether more than half of the pixels clear outside the outline are at full
// scale.
bool IsSurroundSaturated(const OutlinePixels& pixels, const Outline& outline,
                         double cosine, double sine, double full_scale_dn);

// Pixels deeper than `clear_px` inside whose residual is beyond `cut`; none
// where there are too few of them to be more than dust or the tail of the
// noise.
std::vector<core::PixelPoint> Unexplained(const OutlinePixels& pixels,
                                          const std::vector<double>& residuals,
                                          double cut, const Outline& outline,
                                          double cosine, double sine,
                                          double clear_px);

// DepthInside of outline.h with the cosine and sine of the angle at hand.
double DepthInside(const Outline& outline, double x_px, double y_px,
                   double cosine, double sine);

double Extent(const Outline& outline);        // px, centre to farthest point
double SmallestHalf(const Outline& outline);  // px
double Area(const Outline& outline);          // px^2

}  // namespace touchdown::vision
