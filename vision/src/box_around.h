// The part of a clip's picture around a point, or around two parts.
#pragma once

#include <algorithm>
#include <cstdint>

#include "touchdown/core/points.h"
#include "touchdown/vision/clip.h"

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

// An empty one counts for nothing.
inline core::PixelRect BoxAround(const core::PixelRect& a,
                                 const core::PixelRect& b) {
  if (a.width == 0 || a.height == 0) return b;
  if (b.width == 0 || b.height == 0) return a;
  const std::int32_t x = std::min(a.x, b.x);
  const std::int32_t y = std::min(a.y, b.y);
  return {x, y, std::max(a.x + a.width, b.x + b.width) - x,
          std::max(a.y + a.height, b.y + b.height) - y};
}

}  // namespace touchdown::vision
