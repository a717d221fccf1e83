#include "outline/outline_pixels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "outline/appearance.h"
#include "outline/hider.h"

namespace touchdown::vision {

bool UsablePart::IsHidden(double x_px, double y_px) const {
  return hider_->Hides(x_px, y_px);
}

// Distance to the edge, positive inside. Outside a corner it is the distance to
// the corner; inside, that to the nearest side.
double SignedDepth(const Outline& outline, double x_px, double y_px,
                   double cosine, double sine) {
  const double dx = x_px - outline.centre.x_px;
  const double dy = y_px - outline.centre.y_px;
  if (outline.kind == core::BodyKind::kSphere) {
    return outline.radius_px - std::sqrt(dx * dx + dy * dy);
  }
  const double out_u = std::abs(dx * cosine + dy * sine) - outline.half_long_px;
  const double out_v =
      std::abs(-dx * sine + dy * cosine) - outline.half_short_px;
  return out_u > 0.0 && out_v > 0.0 ? -std::sqrt(out_u * out_u + out_v * out_v)
                                    : -std::max(out_u, out_v);
}

// The height above the ground line is linear in the picture: its three
// coefficients.
Height::Height(const std::optional<calib::GroundLine>& ground) {
  if (!ground) return;
  offset_ = calib::HeightAboveLine(*ground, {0.0, 0.0});
  x_ = calib::HeightAboveLine(*ground, {1.0, 0.0}) - offset_;
  y_ = calib::HeightAboveLine(*ground, {0.0, 1.0}) - offset_;
}

// Mean of 3 x 3 pixels of the background, `px` above the place that the body
// hides: what lies behind it without the ground's blurred edge.
double Behind::Raised(std::int32_t x, std::int32_t y, double px) const {
  if (std::min(background_.width_px, background_.height_px) < 3) {
    return static_cast<double>(background_.at(x, y));
  }
  const core::PixelPoint from = height_.Raised(x, y, px);
  const auto inside = [](double at, std::int32_t end) {
    return std::clamp(static_cast<std::int32_t>(std::lround(at)), 1, end - 2);
  };
  const std::int32_t x0 = inside(from.x_px, background_.width_px);
  const std::int32_t y0 = inside(from.y_px, background_.height_px);
  double sum = 0.0;
  for (std::int32_t dy = -1; dy <= 1; ++dy) {
    for (std::int32_t dx = -1; dx <= 1; ++dx) {
      sum += static_cast<double>(background_.at(x0 + dx, y0 + dy));
    }
  }
  return sum / 9.0;
}

// Excludes discs around pixels, as a mask over their box.
void UsablePart::ExcludePixels(const std::vector<core::PixelPoint>& pixels,
                               double reach_px) {
  if (pixels.empty()) return;
  const auto reach = static_cast<std::int32_t>(std::ceil(reach_px));
  double left = pixels[0].x_px, right = left;
  double top = pixels[0].y_px, bottom = top;
  for (const core::PixelPoint& p : pixels) {
    left = std::min(left, p.x_px);
    right = std::max(right, p.x_px);
    top = std::min(top, p.y_px);
    bottom = std::max(bottom, p.y_px);
  }
  box_.x = static_cast<std::int32_t>(left) - reach;
  box_.y = static_cast<std::int32_t>(top) - reach;
  box_.width = static_cast<std::int32_t>(right - left) + 2 * reach + 1;
  box_.height = static_cast<std::int32_t>(bottom - top) + 2 * reach + 1;
  aside_.assign(static_cast<std::size_t>(box_.width) *
                    static_cast<std::size_t>(box_.height),
                0);
  for (const core::PixelPoint& p : pixels) {
    for (std::int32_t dy = -reach; dy <= reach; ++dy) {
      for (std::int32_t dx = -reach; dx <= reach; ++dx) {
        if (dx * dx + dy * dy > reach_px * reach_px) continue;
        const auto x = static_cast<std::int32_t>(p.x_px) + dx - box_.x;
        const auto y = static_cast<std::int32_t>(p.y_px) + dy - box_.y;
        aside_[static_cast<std::size_t>(y) *
                   static_cast<std::size_t>(box_.width) +
               static_cast<std::size_t>(x)] = 1;
      }
    }
  }
}

// Whether a place lies in an excluded disc.
bool UsablePart::IsAside(double x_px, double y_px) const {
  const auto x = static_cast<std::int32_t>(std::lround(x_px)) - box_.x;
  const auto y = static_cast<std::int32_t>(std::lround(y_px)) - box_.y;
  return x >= 0 && y >= 0 && x < box_.width && y < box_.height &&
         aside_[static_cast<std::size_t>(y) *
                    static_cast<std::size_t>(box_.width) +
                static_cast<std::size_t>(x)] != 0;
}

// Distance from the centre to the farthest point.
double Extent(const Outline& o) {
  return o.kind == core::BodyKind::kSphere
             ? o.radius_px
             : std::hypot(o.half_long_px, o.half_short_px);
}

double SmallestHalf(const Outline& o) {
  return o.kind == core::BodyKind::kSphere ? o.radius_px : o.half_short_px;
}

// Changes the radius, or both half sides.
void Grow(double size_px, double other_px, Outline& outline) {
  if (outline.kind == core::BodyKind::kSphere) {
    outline.radius_px += size_px;
  } else {
    outline.half_long_px += size_px;
    outline.half_short_px += other_px;
  }
}

double Area(const Outline& o) {
  return o.kind == core::BodyKind::kSphere
             ? std::numbers::pi * o.radius_px * o.radius_px
             : 4.0 * o.half_long_px * o.half_short_px;
}

// Whether most pixels clear of the body, outside, are at full scale.
bool IsSurroundSaturated(const OutlinePixels& pixels, const Outline& outline,
                         double cosine, double sine, double full_scale_dn) {
  const auto end =
      pixels.value.begin() + static_cast<std::ptrdiff_t>(pixels.size);
  if (std::none_of(pixels.value.begin(), end,
                   [&](double value) { return value >= full_scale_dn; })) {
    return false;
  }
  // px outside the edge: nearer to it the blur mixes the body in. Not studied.
  constexpr double kClear_px = 2.0;
  double outside = 0.0;
  double full = 0.0;
  for (std::size_t i = 0; i < pixels.size; ++i) {
    if (SignedDepth(outline, pixels.x[i], pixels.y[i], cosine, sine) >
        -kClear_px) {
      continue;
    }
    outside += 1.0;
    full += pixels.value[i] >= full_scale_dn;
  }
  return full > 0.5 * outside;
}

// Counts pixels at full scale that fit as if they had no noise: they say
// nothing of it, and would make the misfit too small.
double ClippedAsExpected(const OutlinePixels& pixels,
                         const std::vector<double>& residuals,
                         double full_scale_dn) {
  // In units of the noise; a pixel that is clipped has next to none. Not
  // studied.
  constexpr double kNoNoise = 0.5;
  double count = 0.0;
  for (std::size_t i = 0; i < pixels.size; ++i) {
    count += static_cast<double>(pixels.value[i]) >= full_scale_dn &&
             std::abs(residuals[i]) < kNoNoise;
  }
  return count;
}

// Mean square residual of the pixels near the ground, over that of the others.
NearGroundPixels LookNearGround(const OutlinePixels& pixels,
                                const std::vector<double>& residuals,
                                const Height& height, double below_px) {
  NearGroundPixels result;
  // In most fits no pixel is so low: a loop without branches finds that out.
  int any = 0;
  for (std::size_t i = 0; i < pixels.size; ++i) {
    any |= height.Of(pixels.x[i], pixels.y[i]) < below_px ? 1 : 0;
  }
  if (any == 0) return result;
  double near = 0.0;
  double others = 0.0;
  for (std::size_t i = 0; i < pixels.size; ++i) {
    const double square = residuals[i] * residuals[i];
    if (height.Of(pixels.x[i], pixels.y[i]) < below_px) {
      ++result.pixels;
      near += square;
    } else {
      others += square;
    }
  }
  const int rest = static_cast<int>(pixels.size) - result.pixels;
  if (result.pixels > 0 && rest > 0) {
    result.excess = near / result.pixels / (others / rest);
  }
  return result;
}

// Pixels clear inside the body whose residual exceeds the cut; none where they
// are few.
std::vector<core::PixelPoint> Unexplained(const OutlinePixels& pixels,
                                          const std::vector<double>& residuals,
                                          double cut, const Outline& outline,
                                          double cosine, double sine,
                                          double clear_px) {
  std::vector<core::PixelPoint> unexplained;
  // Pixels: noise has so many beyond the cut now and then. Not studied.
  constexpr std::size_t kMinUnexplained = 4;
  const auto beyond = std::count_if(
      residuals.begin(), residuals.end(),
      [cut](double residual) { return std::abs(residual) > cut; });
  if (beyond < static_cast<std::ptrdiff_t>(kMinUnexplained)) return unexplained;
  std::size_t inside = 0;
  for (std::size_t i = 0; i < pixels.size; ++i) {
    const core::PixelPoint p = {pixels.x[i], pixels.y[i]};
    if (SignedDepth(outline, p.x_px, p.y_px, cosine, sine) < clear_px) continue;
    ++inside;
    if (std::abs(residuals[i]) > cut) unexplained.push_back(p);
  }
  // Share of the pixels clear inside: less does not bias the edge. Not studied.
  constexpr double kMinShare = 0.02;
  const auto least = std::max(
      kMinUnexplained,
      static_cast<std::size_t>(kMinShare * static_cast<double>(inside)));
  if (unexplained.size() < least) unexplained.clear();
  return unexplained;
}

namespace {

// Half the width of a disc's row at distance dy from its centre; negative where
// it has none.
double HalfWidth(double radius, double dy) {
  if (!(radius > std::abs(dy))) return -1.0;
  return std::sqrt(radius * radius - dy * dy);
}

// Takes pixels of a frame, with the background and what lies behind the body
// there.
class Collector {
 public:
  Collector(const core::Frame& frame, const Behind& behind,
            const UsablePart& usable, bool known_background,
            OutlinePixels& pixels)
      : frame_(frame),
        background_(behind.background()),
        behind_(behind),
        usable_(usable),
        ask_known_(known_background && !background_.unknown.empty()),
        pixels_(pixels) {}

  // Promises that all pixels to come lie within `reach_px` of a point. If all
  // of that disc is usable and clear of the ground, no pixel need be asked.
  void StayNearPoint(const core::PixelPoint& centre, double reach_px) {
    ask_ = ask_known_ || !usable_.HoldsDisc(centre, reach_px) ||
           !behind_.IsClearOfGround(centre, reach_px);
  }

  // Takes the pixels of row y from x to `end`, both included.
  void TakeRun(std::int32_t x, std::int32_t end, std::int32_t y) {
    if (ask_) {
      for (; x <= end; ++x) Take(x, y);
      return;
    }
    if (x > end) return;
    const auto count = static_cast<std::size_t>(end - x + 1);
    const float* const background =
        background_.level.data() +
        static_cast<std::ptrdiff_t>(y) * background_.width_px + x;
    const std::int32_t row = y - frame_.origin_y_px;
    const std::int32_t column = x - frame_.origin_x_px;
    if (frame_.is_16_bit()) {
      pixels_.AddRun(x, y, count, frame_.row<std::uint16_t>(row) + column,
                     background);
    } else {
      pixels_.AddRun(x, y, count, frame_.row<std::uint8_t>(row) + column,
                     background);
    }
  }

  void Take(std::int32_t x, std::int32_t y) {
    const auto background = static_cast<double>(background_.at(x, y));
    double behind = background;
    if (ask_) {
      if (!usable_.Holds(x, y)) return;
      if (ask_known_ && !background_.known_at(x, y)) return;
      behind = behind_.At(x, y);
    }
    pixels_.Add(x, y, frame_.at(x - frame_.origin_x_px, y - frame_.origin_y_px),
                background, behind);
  }

 private:
  const core::Frame& frame_;
  const Background& background_;
  const Behind& behind_;
  const UsablePart& usable_;
  bool ask_known_;
  bool ask_ = true;
  OutlinePixels& pixels_;
};

// Adds the appearance to the shading, by taking it off what lies behind. Where
// it is not known well, the body's pixels get less weight.
void AddAppearance(const Appearance& appearance, const Outline& outline,
                   double cosine, double sine, OutlinePixels& pixels) {
  for (std::size_t i = 0; i < pixels.size; ++i) {
    const Appearance::Value value =
        appearance.At(pixels.x[i] - outline.centre.x_px,
                      pixels.y[i] - outline.centre.y_px, cosine, sine);
    pixels.behind[i] -= static_cast<float>(value.level_dn);
    // px: farther outside no pixel is the body's.
    constexpr double kOutside_px = 1.0;
    if (SignedDepth(outline, pixels.x[i], pixels.y[i], cosine, sine) <
        -kOutside_px) {
      continue;
    }
    const double u = value.u_dn * static_cast<double>(pixels.per_noise[i]);
    pixels.per_noise[i] /= static_cast<float>(std::sqrt(1.0 + u * u));
  }
}

// Deep inside a large body there is only the shading to learn: every third
// pixel, the same ones in a mirror.
class Sparse {
 public:
  explicit Sparse(const core::PixelPoint& centre)
      : x_(static_cast<std::int32_t>(std::lround(centre.x_px))),
        y_(static_cast<std::int32_t>(std::lround(centre.y_px))) {}
  bool LeavesOut(std::int32_t x, std::int32_t y) const {
    return (std::abs(x - x_) + std::abs(y - y_)) % 3 != 0;
  }
  // The first that is not left out, at x or after it.
  std::int32_t Next(std::int32_t x, std::int32_t y) const {
    while (LeavesOut(x, y)) ++x;
    return x;
  }

 private:
  std::int32_t x_;
  std::int32_t y_;
};

// The first whole number from `at` on, the last up to it, within a picture.
std::int32_t First(double at, std::int32_t least) {
  return std::max(least, static_cast<std::int32_t>(std::ceil(at)));
}
std::int32_t Last(double at, std::int32_t most) {
  return std::min(most, static_cast<std::int32_t>(std::floor(at)));
}

}  // namespace

void CollectOutlinePixels(const core::Frame& frame, const Behind& behind,
                          const Outline& outline, double cosine, double sine,
                          const UsablePart& usable, const PixelBand& band,
                          OutlinePixels& pixels) {
  const double margin = band.margin_px;
  const bool large = !band.every && SmallestHalf(outline) > 2.0 * margin;
  const Sparse sparse(outline.centre);
  const double reach = Extent(outline) + margin;
  const core::PixelPoint& centre = outline.centre;
  const std::int32_t left = frame.origin_x_px;
  const std::int32_t right = frame.origin_x_px + frame.width_px - 1;
  const std::int32_t x0 = First(centre.x_px - reach, left);
  const std::int32_t x1 = Last(centre.x_px + reach, right);
  const std::int32_t y0 = First(centre.y_px - reach, frame.origin_y_px);
  const std::int32_t y1 =
      Last(centre.y_px + reach, frame.origin_y_px + frame.height_px - 1);
  pixels.Clear(static_cast<std::size_t>(std::max(0, x1 - x0 + 1)) *
               static_cast<std::size_t>(std::max(0, y1 - y0 + 1)));
  const Background& background = behind.background();
  Collector collector(frame, behind, usable, band.known_background, pixels);
  collector.StayNearPoint(centre, std::numbers::sqrt2 * reach);
  for (std::int32_t y = y0; y <= y1; ++y) {
    if (outline.kind == core::BodyKind::kSphere) {
      const double dy = y - centre.y_px;
      const double radius = outline.radius_px;
      const double outer = HalfWidth(radius + margin, dy);
      const double thin = large ? HalfWidth(radius - margin, dy) : -1.0;
      const double inner = HalfWidth(radius - band.inner_px, dy);
      // The edge's band on the left, what is deeper inside, the band on the
      // right.
      const double deep = std::max({thin, inner, 0.0});
      const std::int32_t begin = First(centre.x_px - outer, left);
      const std::int32_t end = Last(centre.x_px + outer, right);
      const std::int32_t middle =
          std::max(begin, Last(centre.x_px - deep, end) + 1);
      const std::int32_t rest =
          std::max(middle, First(centre.x_px + deep, left));
      collector.TakeRun(begin, middle - 1, y);
      if (thin > inner) {
        const std::int32_t middle_end = std::min(rest, end + 1);
        for (std::int32_t x = sparse.Next(middle, y); x < middle_end;
             x = sparse.Next(x + 1, y)) {
          if (std::abs(x - centre.x_px) >= inner) collector.Take(x, y);
        }
      }
      collector.TakeRun(rest, end, y);
      continue;
    }
    for (std::int32_t x = x0; x <= x1; ++x) {
      const double depth = SignedDepth(outline, x, y, cosine, sine);
      if (depth < -margin || depth > band.inner_px) continue;
      if (large && depth > margin && sparse.LeavesOut(x, y)) continue;
      collector.Take(x, y);
    }
  }
  pixels.Finish(background.noise_floor_dn2, background.noise_slope_dn,
                Background::kVarianceFloor_dn2);
  if (band.appearance != nullptr) {
    AddAppearance(*band.appearance, outline, cosine, sine, pixels);
  }
}

// The point of the edge in the direction phi of the body's own axes: of a
// rectangle the place where the ray leaves it.
core::PixelPoint OutlinePoint(const Outline& outline, double cosine,
                              double sine, double phi) {
  double x = outline.radius_px * std::cos(phi);
  double y = outline.radius_px * std::sin(phi);
  if (outline.kind == core::BodyKind::kRectangle) {
    // Where the ray at phi leaves the rectangle.
    const double c = std::cos(phi);
    const double s = std::sin(phi);
    const double t =
        std::min(outline.half_long_px / std::max(std::abs(c), 1e-9),
                 outline.half_short_px / std::max(std::abs(s), 1e-9));
    x = t * (c * cosine - s * sine);
    y = t * (c * sine + s * cosine);
  }
  return {outline.centre.x_px + x, outline.centre.y_px + y};
}

double VisibleShare(const core::Frame& frame, const Outline& outline,
                    double cosine, double sine, const UsablePart& usable) {
  // Most outlines lie in the picture with all of their surroundings: then no
  // point need be probed.
  const double reach = Extent(outline);
  const core::PixelPoint& centre = outline.centre;
  if (centre.x_px - reach >= frame.origin_x_px &&
      centre.y_px - reach >= frame.origin_y_px &&
      centre.x_px + reach <= frame.origin_x_px + frame.width_px - 1 &&
      centre.y_px + reach <= frame.origin_y_px + frame.height_px - 1 &&
      usable.HoldsDisc(centre, reach)) {
    return 1.0;
  }
  // Points probed around the outline, one each 5 deg for a disc: the share is
  // known to 1.4 %. Not studied.
  constexpr int kProbes = 72;
  int seen = 0;
  for (int i = 0; i < kProbes; ++i) {
    const double phi = 2.0 * std::numbers::pi * i / kProbes;
    const auto [x, y] = OutlinePoint(outline, cosine, sine, phi);
    seen += x >= frame.origin_x_px && y >= frame.origin_y_px &&
            x <= frame.origin_x_px + frame.width_px - 1 &&
            y <= frame.origin_y_px + frame.height_px - 1 && usable.Holds(x, y);
  }
  return static_cast<double>(seen) / kProbes;
}

double SignedDepth(const Outline& outline, double x_px, double y_px) {
  return SignedDepth(outline, x_px, y_px, std::cos(outline.angle_rad),
                     std::sin(outline.angle_rad));
}

double SupportHeight(const Outline& outline, double ground_angle_rad) {
  if (outline.kind == core::BodyKind::kSphere) return outline.radius_px;
  const double tilt = outline.angle_rad - ground_angle_rad;
  // S = a |sin| + b |cos| of the angle to the ground.
  return outline.half_long_px * std::abs(std::sin(tilt)) +
         outline.half_short_px * std::abs(std::cos(tilt));
}

}  // namespace touchdown::vision
