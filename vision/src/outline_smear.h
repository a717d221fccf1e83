// The coverage of a pixel by a body that moves while the shutter is open.
#pragma once

#include "outline_model.h"
#include "touchdown/core/points.h"
#include "touchdown/vision/outline.h"

namespace touchdown::vision {

// The image of a body that moves during the exposure: the mean along the way. A
// few places stand for all of it.
class SmearedImage {
 public:
  // `way_px`: during the exposure, `travel_px`: in one frame interval.
  // `d_blur`: of a place's blur by the blur of a body at rest.
  SmearedImage(const StillImage& still, int places,
               const core::PixelPoint& way_px,
               const core::PixelPoint& travel_px, double d_blur)
      : still_(still),
        places_(places),
        share_(1.0 / places),
        way_px_(way_px),
        travel_px_(travel_px),
        d_blur_(d_blur) {}

  Coverage At(double x_px, double y_px) const {
    if (places_ == 1) return still_.At(x_px, y_px);
    Coverage mean;
    for (int i = 0; i < places_; ++i) {
      // The body shifted on is the pixel shifted back.
      const double s = (i + 0.5) * share_ - 0.5;
      const Coverage c =
          still_.At(x_px - s * way_px_.x_px, y_px - s * way_px_.y_px);
      mean.value += c.value;
      for (int k = 0; k < 6; ++k) mean.d[k] += c.d[k];
      mean.xi += c.xi;
      mean.eta += c.eta;
      mean.d_open += s * (c.d[0] * travel_px_.x_px + c.d[1] * travel_px_.y_px);
    }
    mean.value *= share_;
    for (double& d : mean.d) d *= share_;
    mean.xi *= share_;
    mean.eta *= share_;
    mean.d_open *= share_;
    mean.d[5] *= d_blur_;
    return mean;
  }

 private:
  StillImage still_;
  int places_;
  double share_;
  core::PixelPoint way_px_;
  core::PixelPoint travel_px_;
  double d_blur_;
};

// How the exposure is divided. Each place has the blur of its own share of the
// way (of variance step^2 / 12); steps of 0.7 w leave an error of 1e-4 of the
// contrast.
class Smear {
 public:
  // `travel_px`: of the body in one frame interval.
  explicit Smear(const core::PixelPoint& travel_px) : travel_px_(travel_px) {}

  // `open`: the share of the frame interval that is exposed. With `resolved`
  // even a way that adds nothing is divided, for its derivative.
  void Set(double blur_px, double open, bool resolved);

  double way_px() const;  // during the exposure
  SmearedImage ImageOf(const Outline& outline, double cosine,
                       double sine) const {
    return {StillImage(outline, place_blur_px_, cosine, sine),
            places_,
            {open_ * travel_px_.x_px, open_ * travel_px_.y_px},
            travel_px_,
            blur_px_ / place_blur_px_};
  }

 private:
  core::PixelPoint travel_px_;
  double blur_px_ = 1.0;
  double open_ = 0.0;
  int places_ = 1;
  double place_blur_px_ = 1.0;
};

}  // namespace touchdown::vision
