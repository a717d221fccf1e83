// The pixels that an outline is fitted to.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "outline/outline_sums.h"
#include "touchdown/calib/plane.h"
#include "touchdown/core/frame.h"
#include "touchdown/core/points.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/outline/outline.h"

namespace touchdown::vision {

// The height above a ground line; without one everything is far above it.
class Height {
 public:
  Height() = default;
  explicit Height(const std::optional<calib::GroundLine>& ground);
  double Of(double x_px, double y_px) const {
    return x_ * x_px + y_ * y_px + offset_;
  }
  // `px` farther up.
  core::PixelPoint Raised(double x_px, double y_px, double px) const {
    return {x_px + px * x_, y_px + px * y_};
  }

 private:
  double x_ = 0.0;
  double y_ = 0.0;
  double offset_ = std::numeric_limits<double>::infinity();
};

// What the body hides at a pixel: the background there or, near the ground's
// blurred edge, the background above that: the mean of nine pixels.
class Behind {
 public:
  // `zone_px`: where the edge's blur ends.
  Behind(const Background& background, const Height& height, double zone_px)
      : background_(background), height_(height), zone_px_(zone_px) {}
  double At(std::int32_t x, std::int32_t y) const {
    const double height = height_.Of(x, y);
    return height < zone_px_ ? Raised(x, y, zone_px_ - height)
                             : static_cast<double>(background_.at(x, y));
  }
  // Whether nothing within `reach_px` of a point is near the ground's edge.
  bool IsClearOfGround(const core::PixelPoint& point, double reach_px) const {
    return height_.Of(point.x_px, point.y_px) - reach_px >= zone_px_;
  }
  const Background& background() const { return background_; }

 private:
  double Raised(std::int32_t x, std::int32_t y, double px) const;

  const Background& background_;
  Height height_;
  double zone_px_;
};

// What lies higher than a margin above the ground line, is not hidden and not
// set aside.
class UsablePart {
 public:
  UsablePart(const Height& height, double margin_px, const Hider* hider)
      : height_(height), margin_px_(margin_px), hider_(hider) {}
  bool Holds(double x_px, double y_px) const {
    return height_.Of(x_px, y_px) >= margin_px_ &&
           (hider_ == nullptr || !IsHidden(x_px, y_px)) &&
           (aside_.empty() || !IsAside(x_px, y_px));
  }
  // All within `reach_px` of a point.
  bool HoldsDisc(const core::PixelPoint& point, double reach_px) const {
    return height_.Of(point.x_px, point.y_px) - reach_px >= margin_px_ &&
           hider_ == nullptr && aside_.empty();
  }
  // Sets these pixels aside, and all within `reach_px` of any of them.
  void ExcludePixels(const std::vector<core::PixelPoint>& pixels,
                     double reach_px);

 private:
  bool IsAside(double x_px, double y_px) const;
  bool IsHidden(double x_px, double y_px) const;

  Height height_;
  double margin_px_;
  const Hider* hider_;
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
  bool every = false;             // deep inside, too, not one in three
  // Taken from what the body hides, as if it were added to the shading:
  // I = out + c (shading + appearance - behind). Nothing: none.
  const Appearance* appearance = nullptr;
};
void CollectOutlinePixels(const core::Frame& frame, const Behind& behind,
                          const Outline& outline, double cosine, double sine,
                          const UsablePart& usable, const PixelBand& band,
                          OutlinePixels& pixels);

// The point of the outline in the direction phi from its centre; for a
// rectangle from its long side.
core::PixelPoint OutlinePoint(const Outline& outline, double cosine,
                              double sine, double phi);

// Share of the outline that lies in the frame and is usable.
double VisibleShare(const core::Frame& frame, const Outline& outline,
                    double cosine, double sine, const UsablePart& usable);

// Whether more than half of the pixels clear outside the outline are at full
// scale.
bool IsSurroundSaturated(const OutlinePixels& pixels, const Outline& outline,
                         double cosine, double sine, double full_scale_dn);

// How many pixels at full scale are where they are expected. They fit any
// outline that leaves them out, and tell nothing of how well one fits.
double ClippedAsExpected(const OutlinePixels& pixels,
                         const std::vector<double>& residuals,
                         double full_scale_dn);

// How many pixels lie lower than `below_px` above the ground line, and the mean
// square of their residuals over that of the others; 0: there are none of
// either kind.
struct NearGroundPixels {
  int pixels = 0;
  double excess = 0.0;
};
NearGroundPixels LookNearGround(const OutlinePixels& pixels,
                                const std::vector<double>& residuals,
                                const Height& height, double below_px);

// Pixels deeper than `clear_px` inside whose residual is beyond `cut`; none
// where there are too few of them to be more than dust or the tail of the
// noise.
std::vector<core::PixelPoint> Unexplained(const OutlinePixels& pixels,
                                          const std::vector<double>& residuals,
                                          double cut, const Outline& outline,
                                          double cosine, double sine,
                                          double clear_px);

// SignedDepth of outline.h with the cosine and sine of the angle at hand.
double SignedDepth(const Outline& outline, double x_px, double y_px,
                   double cosine, double sine);

// The radius or half the long side by `size_px`, half the other by `other_px`.
void Grow(double size_px, double other_px, Outline& outline);

double Extent(const Outline& outline);        // px, centre to farthest point
double SmallestHalf(const Outline& outline);  // px
double Area(const Outline& outline);          // px^2

}  // namespace touchdown::vision
