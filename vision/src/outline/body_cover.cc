#include "outline/body_cover.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "outline/outline_batch.h"
#include "outline/outline_image.h"
#include "outline/outline_pixels.h"
#include "outline/track_shape.h"

namespace touchdown::vision {
namespace {

// Calls use(x, y) for each pixel inside the outline, clear of its edge.
template <class Use>
void ForEachInnerPixel(const Outline& outline, const Use& use) {
  const double reach = outline.kind == core::BodyKind::kSphere
                           ? outline.radius_px
                           : outline.half_long_px;
  // 30 % of half the smallest side inside the edge.
  const double depth =
      0.3 * (outline.kind == core::BodyKind::kSphere ? outline.radius_px
                                                     : outline.half_short_px);
  const double cosine = std::cos(outline.angle_rad);
  const double sine = std::sin(outline.angle_rad);
  for (int y = static_cast<int>(outline.centre.y_px - reach);
       y <= static_cast<int>(outline.centre.y_px + reach); ++y) {
    for (int x = static_cast<int>(outline.centre.x_px - reach);
         x <= static_cast<int>(outline.centre.x_px + reach); ++x) {
      if (SignedDepth(outline, x, y, cosine, sine) < depth) continue;
      use(x, y);
    }
  }
}

// Mean level of a frame inside the outline.
double MeanInnerLevel(Clip& clip, std::int64_t index, const Outline& outline) {
  const core::Frame frame =
      clip.Read(index, ChooseWindow(outline, {}, clip.info()));
  double sum = 0.0;
  double count = 0.0;
  ForEachInnerPixel(outline, [&](int x, int y) {
    const int u = x - frame.origin_x_px;
    const int v = y - frame.origin_y_px;
    if (u < 0 || v < 0 || u >= frame.width_px || v >= frame.height_px) return;
    sum += frame.at(u, v);
    count += 1.0;
  });
  return count > 0.0 ? sum / count : 0.0;
}

// Mean coverage inside the outline: less than 1 where the body is not much
// wider than its blur.
double MeanCoverage(const Outline& outline, double blur_px) {
  Smear still({0.0, 0.0}, 0.0, 0.0);
  still.Set(blur_px, 0.0, false);
  const OutlineImage image(outline, still);
  std::array<double, kBlock> xs{};
  std::array<double, kBlock> ys{};
  std::size_t filled = 0;
  double sum = 0.0;
  double count = 0.0;
  CoverBlock block;
  const auto flush = [&] {
    image.Cover(xs.data(), ys.data(), block);
    for (std::size_t i = 0; i < filled; ++i)
      sum += static_cast<double>(block.value[i]);
    count += static_cast<double>(filled);
    filled = 0;
  };
  ForEachInnerPixel(outline, [&](int x, int y) {
    xs[filled] = x;
    ys[filled] = y;
    if (++filled == kBlock) flush();
  });
  if (filled > 0) flush();
  return count > 0.0 ? sum / count : 1.0;
}

}  // namespace

// Linear in time; outside of the two frames it extrapolates.
Pose OnTheWay(const Pose& a, const Pose& b, std::int64_t frame) {
  const double share = static_cast<double>(frame - a.frame) /
                       static_cast<double>(b.frame - a.frame);
  Pose pose = a;
  pose.frame = frame;
  pose.centre.x_px += share * (b.centre.x_px - a.centre.x_px);
  pose.centre.y_px += share * (b.centre.y_px - a.centre.y_px);
  pose.angle_rad += share * (b.angle_rad - a.angle_rad);
  return pose;
}

std::optional<Pose> InterpolatePose(const Track& track, std::int64_t frame) {
  const auto after = std::lower_bound(
      track.poses.begin(), track.poses.end(), frame,
      [](const Pose& pose, std::int64_t f) { return pose.frame < f; });
  if (after == track.poses.end()) return std::nullopt;
  if (after->frame == frame) return *after;
  if (after == track.poses.begin()) return std::nullopt;
  return OnTheWay(*(after - 1), *after, frame);
}

// The body's level at both ends of the track is what tells whether it is still
// there beyond them.
BodyCover::BodyCover(Clip& clip, const Track& track)
    : clip_(clip), track_(track) {
  const Pose& first = track.poses.front();
  const Pose& last = track.poses.back();
  level_first_ =
      MeanInnerLevel(clip, first.frame, PlaceOutline(track.body, first));
  level_last_ =
      MeanInnerLevel(clip, last.frame, PlaceOutline(track.body, last));
  cover_inside_ =
      MeanCoverage(PlaceOutline(track.body, first), track.body.blur_px);
}

// Whether the body is gone from its end of the track: the level there has
// changed by more than half of its contrast. Empty frames are the best
// background there is.
bool BodyCover::IsAbsent(std::int64_t frame) const {
  const bool before = frame < track_.poses.front().frame;
  const Pose& end = before ? track_.poses.front() : track_.poses.back();
  const double level =
      MeanInnerLevel(clip_, frame, PlaceOutline(track_.body, end));
  return std::abs(level - (before ? level_first_ : level_last_)) >
         0.5 * cover_inside_ * std::abs(track_.body.contrast_dn);
}

// The pixels that the body may cover: its outline with a margin of three blurs
// and 3 px, for the error of a first outline and for the rim of its shadow.
Cover BodyCover::ComputeCover(const Pose& pose) const {
  const Outline outline = PlaceOutline(track_.body, pose);
  const double margin = 3.0 * track_.body.blur_px + 3.0;
  const double reach =
      margin + (outline.kind == core::BodyKind::kSphere
                    ? outline.radius_px
                    : std::hypot(outline.half_long_px, outline.half_short_px));
  const auto from = [&](double centre) {
    return std::max(0, static_cast<int>(std::floor(centre - reach)));
  };
  const auto to = [&](double centre, std::int32_t size) {
    return std::min(size - 1, static_cast<int>(std::ceil(centre + reach)));
  };
  Cover cover;
  core::PixelRect& box = cover.box;
  box.x = from(outline.centre.x_px);
  box.y = from(outline.centre.y_px);
  box.width = to(outline.centre.x_px, clip_.info().width_px) - box.x + 1;
  box.height = to(outline.centre.y_px, clip_.info().height_px) - box.y + 1;
  if (box.width <= 0 || box.height <= 0) {
    box = {};
    return cover;
  }
  cover.mask.reserve(static_cast<std::size_t>(box.width) *
                     static_cast<std::size_t>(box.height));
  const double cosine = std::cos(outline.angle_rad);
  const double sine = std::sin(outline.angle_rad);
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      const double depth = SignedDepth(outline, x, y, cosine, sine);
      cover.mask.push_back(depth > -margin ? 1 : 0);
    }
  }
  return cover;
}

Cover BodyCover::CoverInFrame(std::int64_t frame) const {
  if (const std::optional<Pose> pose = InterpolatePose(track_, frame)) {
    return ComputeCover(*pose);
  }
  if (IsAbsent(frame)) return {};
  const bool before = frame < track_.poses.front().frame;
  Cover cover =
      ComputeCover(before ? track_.poses.front() : track_.poses.back());
  // Beyond the ends the body is at rest where it was seen last, or has gone:
  // not known.
  cover.known = false;
  return cover;
}

}  // namespace touchdown::vision
