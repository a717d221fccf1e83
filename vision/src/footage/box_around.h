// The part of a clip's picture around a point.
#pragma once

#include <algorithm>
#include <cstdint>

#include "touchdown/core/points.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

// All within `reach_px` of `centre`, at least one pixel.
inline core::PixelRect BoxAround(const core::PixelPoint& centre,
                                 double reach_px, const ClipInfo& info) {
  const auto within = [](double at, std::int32_t end) {
    return static_cast<std::int32_t>(std::clamp(at, 0.0, end - 1.0));
  };
  core::PixelRect rect;
  rect.x = within(centre.x_px - reach_px, info.width_px);
  rect.y = within(centre.y_px - reach_px, info.height_px);
  rect.width = within(centre.x_px + reach_px + 1.0, info.width_px) - rect.x + 1;
  rect.height =
      within(centre.y_px + reach_px + 1.0, info.height_px) - rect.y + 1;
  return rect;
}

}  // namespace touchdown::vision
