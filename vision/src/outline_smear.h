// The coverage of a pixel by a body that moves while the shutter is open.
#pragma once

#include "outline_model.h"
#include "touchdown/core/points.h"
#include "touchdown/vision/outline.h"

namespace touchdown::vision {

// The mean along the way: a few places stand for all of it, each with the blur
// of its own share of the way (of variance step^2 / 12). Steps of 0.7 w leave
// an error of 1e-4 of the contrast.
class Smear {
 public:
  // `travel_px`: of the body in one frame interval.
  explicit Smear(const core::PixelPoint& travel_px) : travel_px_(travel_px) {}

  // `open`: the share of the frame interval that is exposed. With `resolved`
  // even a way that adds nothing is divided, for its derivative.
  void Set(double blur_px, double open, bool resolved);

  double way_px() const;  // during the exposure
  Coverage At(const Outline& outline, double x_px, double y_px, double cosine,
              double sine) const;

 private:
  core::PixelPoint travel_px_;
  double blur_px_ = 1.0;
  double open_ = 0.0;
  int places_ = 1;
  double place_blur_px_ = 1.0;
};

}  // namespace touchdown::vision
