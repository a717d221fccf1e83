#include "tracking/whole_body.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "numbers/robust.h"
#include "outline/outline_pixels.h"
#include "outline/track_shape.h"
#include "track/image_size.h"
#include "tracking/best_outline.h"
#include "tracking/co_moving.h"

namespace touchdown::vision {
namespace {

// The part's outline about its centre: at angle 0 where the axes are those of
// the poses, else at its median angle.
Outline PartOutline(const Track& part, bool turns) {
  std::vector<double> angles;
  angles.reserve(part.poses.size());
  for (const Pose& pose : part.poses) angles.push_back(pose.angle_rad);
  Pose pose;
  if (!turns) pose.angle_rad = Median(std::move(angles));
  return PlaceOutline(part.body, pose);
}

// What hides the still layer: the cells within `margin_px` of the outline, and
// those around each moving cell.
std::vector<unsigned char> ComputeCover(const CoMoving& places,
                                        const Outline& outline,
                                        double margin_px) {
  const int n = places.size();
  const double cosine = std::cos(outline.angle_rad);
  const double sine = std::sin(outline.angle_rad);
  std::vector<unsigned char> cover;
  cover.reserve(places.says.size());
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      const double depth =
          SignedDepth(outline, (column - places.half) * places.spacing_px,
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

// The better of rectangle and disc, unless the kind is stated.
std::optional<BestOutline> FindOutlineOfBestKind(
    const CoMoving& places, const std::optional<core::BodyKind>& kind,
    bool finely, const core::Cancellation& until) {
  std::optional<BestOutline> best;
  for (const core::BodyKind k :
       {core::BodyKind::kRectangle, core::BodyKind::kSphere}) {
    if (kind && *kind != k) continue;
    const auto found = FindBestOutline(places, k, finely, until);
    if (found && (!best || found->merit > best->merit)) best = found;
  }
  return best;
}

// Labels the cells within a reach of the path and fits an outline to them.
// `guess`: the outline that hides the still layer until labels tell a better
// one.
std::optional<BestOutline> FindOutlineInReach(
    Clip& clip, const Background& background, const Track& part,
    const Outline& guess, const std::optional<core::BodyKind>& kind,
    const CoMovingOptions& options) {
  // px: blur, and how far a part's poses wander. Smaller puts the body's rim
  // into the still layer; larger leaves that layer unknown beside it. Not
  // studied.
  constexpr double kMargin_px = 4.0;
  const CoMoving places = FindCoMoving(
      clip, background, part,
      [&](const CoMoving& seen) {
        const auto found = FindOutlineOfBestKind(
            seen, kind.value_or(core::BodyKind::kRectangle), false,
            clip.cancellation());
        return ComputeCover(seen, found ? found->outline : guess, kMargin_px);
      },
      options);
  if (places.half == 0) return std::nullopt;
  return FindOutlineOfBestKind(places, kind, true, clip.cancellation());
}

// Whether one outline holds most of what moves along, and little else.
bool IsOne(const BestOutline& best) {
  // Recall and precision of the labelled cells. Larger loses bodies with large
  // parts like the wall behind; smaller takes two bodies for one. Set with the
  // recorded cart.
  constexpr double kMinRecall = 0.7;
  constexpr double kMinPrecision = 0.7;
  return best.holds > kMinRecall && best.pure > kMinPrecision;
}

// Searches in growing squares around the path, so that a small body costs
// little, then once more at full resolution.
std::optional<BestOutline> FindOutlineNearPath(Clip& clip,
                                               const Background& background,
                                               const Track& part,
                                               const TrackOptions& wanted,
                                               bool turns) {
  // Reaches in units of the part's greatest extent: of a part that is one end
  // of a bar, the other end is ten of its sizes away. Set with the recorded
  // cart.
  constexpr double kReaches[] = {3.0, 6.0, 12.0};
  // px of still surroundings beside the outline in the last search: without
  // them nothing bounds the outline. Not studied.
  constexpr double kBeside_px = 12.0;
  const Outline own = PartOutline(part, turns);
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
        FindOutlineInReach(clip, background, part, best ? best->outline : own,
                           wanted.kind, options);
    if (found && IsOne(*found) && (!best || found->merit > best->merit)) {
      best = found;
    }
  }
  if (!best) return std::nullopt;
  // Once more at the finest cells that the smaller reach allows.
  const Outline& rough = best->outline;
  options.reach_px = std::hypot(rough.centre.x_px, rough.centre.y_px) +
                     Extent(rough) + kBeside_px;
  const auto found =
      FindOutlineInReach(clip, background, part, rough, wanted.kind, options);
  return found && IsOne(*found) ? found : std::nullopt;
}

// Whether the part's direction changes by what can be seen and is not noise.
bool Turns(const Track& part) {
  if (part.body.kind == core::BodyKind::kSphere) return false;
  // px at the part's far end. Less leaves its picture as sharp with axes that
  // do not turn. Not studied.
  constexpr double kMinTurn_px = 2.0;
  // Range of the angles (10 % to 90 %) over their median step from pose to
  // pose: noise alone gives 2.7. Not studied.
  constexpr double kMinRangePerStep = 4.0;
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
  return range * Extent(PartOutline(part, false)) > kMinTurn_px &&
         range > kMinRangePerStep * Median(std::move(steps));
}

}  // namespace

std::optional<Track> FindWhole(Clip& clip, const Background& background,
                               const Track& part, const TrackOptions& options) {
  if (part.step > 1 || !IsSteady(part)) return std::nullopt;
  clip.cancellation().Enter("the whole of the body is looked for");
  // Ratio of the areas: a whole that is hardly larger than the part is the
  // part. Not studied.
  constexpr double kMinAreaRatio = 1.5;
  std::optional<BestOutline> best;
  bool best_turns = false;
  for (const bool turns : {false, true}) {
    if (turns && !Turns(part)) continue;
    const auto found =
        FindOutlineNearPath(clip, background, part, options, turns);
    if (!found) continue;
    if (!best || found->merit > best->merit) {
      best = found;
      best_turns = turns;
    }
  }
  if (!best || Area(best->outline) <
                   kMinAreaRatio * Area(PartOutline(part, best_turns))) {
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
  // px: u of an edge that was found by cells. Not studied.
  constexpr double kCellU_px = 0.5;
  if (outline.kind == core::BodyKind::kSphere) {
    whole.body.radius_px = {outline.radius_px, kCellU_px, std::nullopt};
  } else {
    whole.body.half_long_px = {outline.half_long_px, kCellU_px, std::nullopt};
    whole.body.half_short_px = {outline.half_short_px, kCellU_px, std::nullopt};
    whole.body.u_common_angle_rad = kCellU_px / outline.half_long_px;
  }
  whole.body.u_common_px = kCellU_px;
  whole.body.u_texture_px = kCellU_px;
  for (Pose& pose : whole.poses) {
    const double cosine = best_turns ? std::cos(pose.angle_rad) : 1.0;
    const double sine = best_turns ? std::sin(pose.angle_rad) : 0.0;
    const core::PixelPoint& from = outline.centre;
    // The whole's centre lies at a fixed place in the part's axes.
    pose.centre.x_px += from.x_px * cosine - from.y_px * sine;
    pose.centre.y_px += from.x_px * sine + from.y_px * cosine;
    pose.angle_rad = outline.kind == core::BodyKind::kSphere ? 0.0
                     : best_turns ? pose.angle_rad + outline.angle_rad
                                  : outline.angle_rad;
  }
  return whole;
}

Track MakePath(const Chain& chain, const Track& like) {
  Track path = like;
  path.step = 1;
  // A disc of the blobs' area stands for the body.
  path.body.kind = core::BodyKind::kSphere;
  path.body.radius_px = {std::sqrt(chain.Area() / std::numbers::pi), 0.0,
                         std::nullopt};
  // px: u of a blob's centre. Not studied.
  constexpr double kBlobU_px = 1.0;
  const double misfit = MedianMisfit(like.poses);
  path.poses.clear();
  for (const Link& link : chain.links) {
    Pose pose;
    pose.frame = link.frame;
    pose.time_s = link.time_s;
    pose.centre = link.blob.centre;
    pose.u_x_px = pose.u_y_px = kBlobU_px;
    pose.misfit = misfit;
    path.poses.push_back(pose);
  }
  return path;
}

}  // namespace touchdown::vision
