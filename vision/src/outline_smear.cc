#include "outline_smear.h"

#include <algorithm>
#include <cmath>

namespace touchdown::vision {
namespace {

Coverage StillCoverage(const Outline& outline, double blur, double x, double y,
                       double cosine, double sine) {
  return outline.kind == core::BodyKind::kSphere
             ? DiscCoverage(outline, blur, x, y)
             : RectangleCoverage(outline, blur, x, y, cosine, sine);
}

}  // namespace

double Smear::way_px() const {
  return open_ * std::hypot(travel_px_.x_px, travel_px_.y_px);
}

void Smear::Set(double blur_px, double open, bool resolved) {
  constexpr double kStep = 0.7;         // of the blur
  constexpr double kNegligible = 0.15;  // of the blur: its square adds 0.2 %
  blur_px_ = blur_px;
  open_ = open;
  const double way = way_px();
  places_ = 1;
  if (way > kNegligible * blur_px || resolved) {
    constexpr int kMost = 96;
    places_ = std::clamp(static_cast<int>(std::ceil(way / (kStep * blur_px))),
                         2, kMost);
  }
  const double step = way / places_;
  place_blur_px_ = std::sqrt(blur_px * blur_px + step * step / 12.0);
}

Coverage Smear::At(const Outline& outline, double x_px, double y_px,
                   double cosine, double sine) const {
  if (places_ == 1) {
    return StillCoverage(outline, place_blur_px_, x_px, y_px, cosine, sine);
  }
  Coverage mean;
  Outline shifted = outline;
  const double share = 1.0 / places_;
  for (int i = 0; i < places_; ++i) {
    const double s = (i + 0.5) * share - 0.5;
    shifted.centre.x_px = outline.centre.x_px + s * open_ * travel_px_.x_px;
    shifted.centre.y_px = outline.centre.y_px + s * open_ * travel_px_.y_px;
    const Coverage c =
        StillCoverage(shifted, place_blur_px_, x_px, y_px, cosine, sine);
    mean.value += share * c.value;
    for (int k = 0; k < 6; ++k) mean.d[k] += share * c.d[k];
    mean.xi += share * c.xi;
    mean.eta += share * c.eta;
    mean.d_open +=
        share * s * (c.d[0] * travel_px_.x_px + c.d[1] * travel_px_.y_px);
  }
  mean.d[5] *= blur_px_ / place_blur_px_;
  return mean;
}

}  // namespace touchdown::vision
