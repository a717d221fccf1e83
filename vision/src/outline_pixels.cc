#include "outline_pixels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "outline_model.h"

namespace touchdown::vision {

UsableSide::UsableSide(const std::optional<calib::GroundLine>& ground,
                       double margin_px) {
  if (!ground) return;
  const double origin = calib::HeightAbove(*ground, {0.0, 0.0});
  x_ = calib::HeightAbove(*ground, {1.0, 0.0}) - origin;
  y_ = calib::HeightAbove(*ground, {0.0, 1.0}) - origin;
  offset_ = origin - margin_px;
}

double Extent(const Outline& o) {
  return o.kind == core::BodyKind::kSphere
             ? o.radius_px
             : std::hypot(o.half_long_px, o.half_short_px);
}

double SmallestHalf(const Outline& o) {
  return o.kind == core::BodyKind::kSphere ? o.radius_px : o.half_short_px;
}

void CollectOutlinePixels(const core::Frame& frame,
                          const Background& background, const Outline& outline,
                          double cosine, double sine, const UsableSide& usable,
                          const PixelBand& band,
                          std::vector<OutlinePixel>& pixels) {
  const double margin = band.margin_px;
  const bool large = SmallestHalf(outline) > 2.0 * margin;
  const double reach = Extent(outline) + margin;
  const auto x0 = std::max<std::int32_t>(
      frame.origin_x_px,
      static_cast<std::int32_t>(std::ceil(outline.centre.x_px - reach)));
  const auto y0 = std::max<std::int32_t>(
      frame.origin_y_px,
      static_cast<std::int32_t>(std::ceil(outline.centre.y_px - reach)));
  const auto x1 = std::min<std::int32_t>(
      frame.origin_x_px + frame.width_px - 1,
      static_cast<std::int32_t>(std::floor(outline.centre.x_px + reach)));
  const auto y1 = std::min<std::int32_t>(
      frame.origin_y_px + frame.height_px - 1,
      static_cast<std::int32_t>(std::floor(outline.centre.y_px + reach)));
  pixels.clear();
  for (std::int32_t y = y0; y <= y1; ++y) {
    for (std::int32_t x = x0; x <= x1; ++x) {
      if (!usable.Holds(x, y)) continue;
      if (band.known_background && !background.known_at(x, y)) continue;
      const double depth = DepthInside(outline, x, y, cosine, sine);
      if (depth < -margin || depth > band.inner_px) continue;
      // Deep inside there is only the shading to learn: every third pixel.
      if (large && depth > margin && (x + y) % 3 != 0) continue;
      OutlinePixel p;
      p.x = x;
      p.y = y;
      p.value = frame.at(x - frame.origin_x_px, y - frame.origin_y_px);
      p.background = static_cast<double>(background.at(x, y));
      p.variance = background.Variance(p.value);
      pixels.push_back(p);
    }
  }
}

double VisibleShare(const core::Frame& frame, const Outline& outline,
                    double cosine, double sine, const UsableSide& usable) {
  constexpr int kProbes = 72;
  int seen = 0;
  for (int i = 0; i < kProbes; ++i) {
    const double phi = 2.0 * std::numbers::pi * i / kProbes;
    double x = 0.0;
    double y = 0.0;
    if (outline.kind == core::BodyKind::kSphere) {
      x = outline.radius_px * std::cos(phi);
      y = outline.radius_px * std::sin(phi);
    } else {
      // Where the ray at phi leaves the rectangle.
      const double c = std::cos(phi);
      const double s = std::sin(phi);
      const double t =
          std::min(outline.half_long_px / std::max(std::abs(c), 1e-9),
                   outline.half_short_px / std::max(std::abs(s), 1e-9));
      x = t * (c * cosine - s * sine);
      y = t * (c * sine + s * cosine);
    }
    x += outline.centre.x_px;
    y += outline.centre.y_px;
    seen += x >= frame.origin_x_px && y >= frame.origin_y_px &&
            x <= frame.origin_x_px + frame.width_px - 1 &&
            y <= frame.origin_y_px + frame.height_px - 1 && usable.Holds(x, y);
  }
  return static_cast<double>(seen) / kProbes;
}

}  // namespace touchdown::vision
