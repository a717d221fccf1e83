#include "outline_smear.h"

#include <algorithm>
#include <cmath>

namespace touchdown::vision {
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

}  // namespace touchdown::vision
