#include "whole_body.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "best_outline.h"
#include "co_moving.h"
#include "outline_pixels.h"
#include "track_shape.h"

namespace touchdown::vision {
namespace {

// The outline as its pose has it, its axes being `turns` or not the pose's.
Outline PartAt(const Track& part, bool turns) {
  std::vector<double> angles;
  angles.reserve(part.poses.size());
  for (const Pose& pose : part.poses) angles.push_back(pose.angle_rad);
  Pose pose;
  if (!turns) pose.angle_rad = Median(std::move(angles));
  return OutlineAt(part.body, pose);
}

// What an outline covers of the places, and of those around it that move
// along.
std::vector<unsigned char> CoverOf(const CoMoving& places,
                                   const Outline& outline, double margin_px) {
  const int n = places.size();
  const double cosine = std::cos(outline.angle_rad);
  const double sine = std::sin(outline.angle_rad);
  std::vector<unsigned char> cover;
  cover.reserve(places.says.size());
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      const double depth =
          DepthInside(outline, (column - places.half) * places.spacing_px,
                      (row - places.half) * places.spacing_px, cosine, sine);
      cover.push_back(depth > -margin_px ? 1 : 0);
    }
  }
  const auto reach = static_cast<int>(std::ceil(margin_px / places.spacing_px));
  for (int row = reach; row < n - reach; ++row) {
    for (int column = reach; column < n - reach; ++column) {
      const auto i = static_cast<std::size_t>(row * n + column);
      if (places.says[i] <= 0) continue;
      for (int v = -reach; v <= reach; ++v) {
        for (int u = -reach; u <= reach; ++u) {
          cover[i + static_cast<std::size_t>(v * n + u)] = 1;
        }
      }
    }
  }
  return cover;
}

std::optional<BestOutline> BestOf(const CoMoving& places,
                                  const std::optional<core::BodyKind>& kind,
                                  bool finely,
                                  const core::Cancellation& until) {
  std::optional<BestOutline> best;
  for (const core::BodyKind k :
       {core::BodyKind::kRectangle, core::BodyKind::kSphere}) {
    if (kind && *kind != k) continue;
    const auto found = FindBestOutline(places, k, finely, until);
    if (found && (!best || found->merit > best->merit)) best = found;
  }
  return best;
}

// What moves along within a reach of the path, its first guess being `guess`.
std::optional<BestOutline> FindOutlineWithin(
    Clip& clip, const Background& background, const Track& part,
    const Outline& guess, const std::optional<core::BodyKind>& kind,
    const CoMovingOptions& options) {
  constexpr double kMargin_px = 4.0;  // blur, and what a part's poses wander
  const CoMoving places = FindCoMoving(
      clip, background, part,
      [&](const CoMoving& seen) {
        const auto found =
            BestOf(seen, kind.value_or(core::BodyKind::kRectangle), false,
                   clip.cancellation());
        return CoverOf(seen, found ? found->outline : guess, kMargin_px);
      },
      options);
  if (places.half == 0) return std::nullopt;
  return BestOf(places, kind, true, clip.cancellation());
}

// One outline holds what moves along, and little else.
bool IsOne(const BestOutline& best) {
  constexpr double kHolds = 0.7;
  constexpr double kPure = 0.7;
  return best.holds > kHolds && best.pure > kPure;
}

std::optional<BestOutline> FindOutlineAround(Clip& clip,
                                             const Background& background,
                                             const Track& part,
                                             const TrackOptions& wanted,
                                             bool turns) {
  // Of an end the other one is ten of its sizes away.
  constexpr double kReaches[] = {3.0, 6.0, 12.0};  // of the part's
  constexpr double kBeside_px = 12.0;
  const Outline own = PartAt(part, turns);
  const double most = std::max(clip.info().width_px, clip.info().height_px);
  CoMovingOptions options;
  options.turns = turns;
  options.threads = wanted.threads;
  options.ground = wanted.ground;
  std::optional<BestOutline> best;
  for (const double reach : kReaches) {
    options.reach_px = reach * Extent(own);
    if (options.reach_px > most) break;
    const auto found =
        FindOutlineWithin(clip, background, part, best ? best->outline : own,
                          wanted.kind, options);
    if (found && IsOne(*found) && (!best || found->merit > best->merit)) {
      best = found;
    }
  }
  if (!best) return std::nullopt;
  // Once more, as finely as it goes.
  const Outline& rough = best->outline;
  options.reach_px = std::hypot(rough.centre.x_px, rough.centre.y_px) +
                     Extent(rough) + kBeside_px;
  const auto found =
      FindOutlineWithin(clip, background, part, rough, wanted.kind, options);
  return found && IsOne(*found) ? found : std::nullopt;
}

// Whether the part's direction changes, by what can be seen and is no noise.
bool Turns(const Track& part) {
  if (part.body.kind == core::BodyKind::kSphere) return false;
  constexpr double kSeen_px = 2.0;  // at its far end
  constexpr double kNoNoise = 4.0;  // where noise alone gives 2.7
  std::vector<double> angles;
  std::vector<double> steps;
  for (const Pose& pose : part.poses) {
    if (!angles.empty()) {
      steps.push_back(std::abs(pose.angle_rad - angles.back()));
    }
    angles.push_back(pose.angle_rad);
  }
  std::sort(angles.begin(), angles.end());
  const std::size_t tenth = angles.size() / 10;
  const double range = angles[angles.size() - 1 - tenth] - angles[tenth];
  return range * Extent(PartAt(part, false)) > kSeen_px &&
         range > kNoNoise * Median(std::move(steps));
}

}  // namespace

std::optional<Track> FindWhole(Clip& clip, const Background& background,
                               const Track& part, const TrackOptions& options) {
  if (part.step > 1 || !IsSteady(part)) return std::nullopt;
  clip.cancellation().Enter("the whole of the body is looked for");
  constexpr double kLarger = 1.5;  // than the part
  std::optional<BestOutline> best;
  bool best_turns = false;
  for (const bool turns : {false, true}) {
    if (turns && !Turns(part)) continue;
    const auto found =
        FindOutlineAround(clip, background, part, options, turns);
    if (!found) continue;
    if (!best || found->merit > best->merit) {
      best = found;
      best_turns = turns;
    }
  }
  if (!best || Area(best->outline) < kLarger * Area(PartAt(part, best_turns))) {
    return std::nullopt;
  }
  Track whole = part;
  whole.outlined = false;
  if (!best->settled) {
    whole.warnings.emplace_back(
        "the outline of all that moves as one was still growing at the bound "
        "of its search; its size may be off");
  }
  const Outline& outline = best->outline;
  whole.body = {};
  whole.body.kind = outline.kind;
  whole.body.blur_px = part.body.blur_px;
  whole.body.contrast_dn = part.body.contrast_dn;
  constexpr double kOfPlaces = 0.5;  // px, what a place's edge tells
  if (outline.kind == core::BodyKind::kSphere) {
    whole.body.radius_px = {outline.radius_px, kOfPlaces, std::nullopt};
  } else {
    whole.body.half_long_px = {outline.half_long_px, kOfPlaces, std::nullopt};
    whole.body.half_short_px = {outline.half_short_px, kOfPlaces, std::nullopt};
    whole.body.u_common_angle_rad = kOfPlaces / outline.half_long_px;
  }
  whole.body.u_common_px = kOfPlaces;
  for (Pose& pose : whole.poses) {
    const double cosine = best_turns ? std::cos(pose.angle_rad) : 1.0;
    const double sine = best_turns ? std::sin(pose.angle_rad) : 0.0;
    const core::PixelPoint& from = outline.centre;
    pose.centre.x_px += from.x_px * cosine - from.y_px * sine;
    pose.centre.y_px += from.x_px * sine + from.y_px * cosine;
    pose.angle_rad = outline.kind == core::BodyKind::kSphere ? 0.0
                     : best_turns ? pose.angle_rad + outline.angle_rad
                                  : outline.angle_rad;
  }
  return whole;
}

Track PathOf(const Chain& chain, const Track& like) {
  Track path = like;
  path.step = 1;
  path.body.kind = core::BodyKind::kSphere;
  path.body.radius_px = {std::sqrt(chain.Area() / std::numbers::pi), 0.0,
                         std::nullopt};
  constexpr double kOfBlob_px = 1.0;  // what a blob's centre tells
  const double misfit = MedianMisfit(like.poses);
  path.poses.clear();
  for (const Link& link : chain.links) {
    Pose pose;
    pose.frame = link.frame;
    pose.time_s = link.time_s;
    pose.centre = link.blob.centre;
    pose.u_x_px = pose.u_y_px = kOfBlob_px;
    pose.misfit = misfit;
    path.poses.push_back(pose);
  }
  return path;
}

}  // namespace touchdown::vision
