#include "tracking/layered_track.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <utility>
#include <vector>

#include "detection/first_look.h"
#include "detection/layered_start.h"
#include "outline/body_cover.h"
#include "outline/outline_batch.h"
#include "outline/track_shape.h"
#include "tracking/track_cover.h"

namespace touchdown::vision {
namespace {

// Relative difference of a picture's size and the stated one of the same body:
// gamma and blur move both edges by half a pixel at most. Larger takes another
// body for it; smaller loses small bodies (3 % of 33 px are two half pixels).
// Not studied.
constexpr double kMaxSizeDifference = 0.03;
// A difference of so many u passes always. Not studied.
constexpr double kSizeSigmas = 4.0;

bool IsStatedLength(double found_px, const core::Estimate& stated) {
  return std::abs(found_px - stated.value) <=
         std::max(kSizeSigmas * stated.u, kMaxSizeDifference * stated.value);
}

KnownShape MakeKnownShape(core::BodyKind kind, const BodySize& size) {
  return {kind, size.long_px.value,
          kind == core::BodyKind::kSphere ? size.long_px.value
                                          : size.short_px.value};
}

// The layered start as a track of the stated size. Its blur stands for the
// start's error of place: so much beyond the outline is not taken for
// background (BodyCover).
Track TrackOfStart(const Clip& clip, const TrackOptions& options,
                   std::int64_t last, const std::vector<StartPose>& start) {
  // Of the short side: a third of BodyCover's margin. Not studied.
  constexpr double kPlaceError = 0.04;
  const BodySize& size = *options.size;
  Track track;
  track.first_frame = options.first;
  track.last_frame = last;
  track.frame_interval_s = 1.0 / clip.info().time_base.fps;
  BodyImage& body = track.body;
  body.kind = *options.kind;
  if (body.kind == core::BodyKind::kSphere) {
    body.radius_px = core::Scaled(size.long_px, 0.5);
  } else {
    body.half_long_px = core::Scaled(size.long_px, 0.5);
    body.half_short_px = core::Scaled(size.short_px, 0.5);
  }
  body.blur_px = kPlaceError * MakeKnownShape(body.kind, size).short_side;
  for (const StartPose& at : start) {
    if (!at.seen) continue;
    Pose pose;
    pose.frame = at.frame;
    pose.centre = at.centre;
    pose.angle_rad = at.angle_rad;
    track.poses.push_back(pose);
  }
  return track;
}

// Fits outlines in frames that are spread over those that the track spans, from
// its own poses.
std::vector<Fitted> FitTrackOutlines(Clip& clip, const Background& background,
                                     const TrackOptions& options,
                                     const Track& track,
                                     const OutlineOptions& fit_options) {
  // Layers measure every frame from what so many tell of size, blur and way. 24
  // gave 139 photographed clips the same errors; more cost time.
  constexpr std::int64_t kEnough = 40;
  // Frames: where a blow lies between, the way from one to the next is some
  // pixels off. Not studied.
  constexpr std::int64_t kMostStep = 4;
  const std::int64_t first = track.poses.front().frame;
  const std::int64_t last = track.poses.back().frame;
  const std::int64_t step = std::min((last - first) / kEnough + 1, kMostStep);
  std::vector<OutlineJob> jobs;
  for (std::int64_t f = first; f <= last; f += step) {
    jobs.push_back({f, PlaceOutline(track.body, *InterpolatePose(track, f))});
  }
  return Found(
      FitOutlines(clip, background, jobs, fit_options, options.threads));
}

// What is held of the size in a pass over the frames: that of the track, which
// is the stated one at first. Once the places are right the picture may tell
// it. Where the background is not known at one end of the body, a free size
// draws the place along: at last the size of all frames is held.
enum class Size { kHeld, kFree };

// Outlines of the stated size from a track's poses, in as many passes.
core::Expected<TrackResult> FitOutlinesOfSize(
    Clip& clip, const TrackOptions& options, Track from,
    const Background& fallback, std::initializer_list<Size> passes) {
  // Frames: fewer make no path.
  constexpr std::size_t kMinPoses = 3;
  const auto too_few = [] {
    return core::AbsentBecause("too few outlines of the stated size");
  };
  if (from.poses.size() < kMinPoses) return too_few();
  TrackResult result;
  Track& track = result.track;
  track = std::move(from);
  bool is_first = true;
  for (const Size size : passes) {
    result.background = EstimateUncovered(clip, options, track, fallback);
    OutlineOptions fit_options;
    fit_options.ground = options.ground;
    // px. Layers start from rougher poses than that. Where the body's face is
    // no quadratic, robust weights settle slowly: to 1e-4 px it takes 20 to 30
    // rounds.
    constexpr double kTolerance_px = 0.005;
    fit_options.tolerance_px = kTolerance_px;
    fit_options.fit_size = size == Size::kFree;
    if (size == Size::kFree) fit_options.blur_px = track.body.blur_px;
    std::vector<Fitted> fits =
        FitTrackOutlines(clip, result.background, options, track, fit_options);
    std::erase_if(fits, [](const Fitted& f) { return !IsMeasured(f.fit); });
    DropStrangers(fits);
    // A frame's own size may differ from the stated one by its own u as well.
    std::erase_if(fits, [&](const Fitted& f) {
      core::Estimate stated = options.size->long_px;
      stated.u = std::hypot(stated.u, 2.0 * f.fit.u_size_px);
      return !IsStatedLength(2.0 * OutlineSize(f.fit), stated);
    });
    if (is_first && fits.size() < kMinPoses) return too_few();
    // Share of the poses that a later pass must keep. If it keeps fewer, it was
    // led astray, and the pass before knew them better. Not studied.
    constexpr double kLeastKept = 0.8;
    if (!is_first &&
        static_cast<double>(fits.size()) <
            std::max(static_cast<double>(kMinPoses),
                     kLeastKept * static_cast<double>(track.poses.size()))) {
      break;
    }
    track.warnings.clear();
    FillTrack(fits, *options.kind, track);
    is_first = false;
  }
  return result;
}

// The start that explains more of those of both kinds, or of the stated one.
core::Expected<SizedStart> FindKindAndSize(Clip& clip,
                                           std::optional<core::BodyKind> stated,
                                           LayeredStartOptions options) {
  // Of what is unexplained: a rectangle has more sides to fit. A ball's was up
  // to 0.003 less as a rectangle, a block's 0.03 to 0.4 less than as a disc.
  constexpr double kOfMoreSides = 0.01;
  const auto of_kind = [&](core::BodyKind kind) -> core::Expected<SizedStart> {
    if (stated && *stated != kind) return core::AbsentBecause("another kind");
    options.shape.kind = kind;
    return FindSizedStart(clip, options);
  };
  auto disc = of_kind(core::BodyKind::kSphere);
  auto rectangle = of_kind(core::BodyKind::kRectangle);
  if (!disc) return rectangle;
  if (!rectangle) return disc;
  return rectangle->unexplained < (1.0 - kOfMoreSides) * disc->unexplained
             ? rectangle
             : disc;
}

BodySize SizeOfStart(const KnownShape& shape) {
  constexpr double kCell_px = 2.0;  // what it was sought in
  return {{shape.long_side, kCell_px, std::nullopt},
          {shape.short_side, kCell_px, std::nullopt}};
}

}  // namespace

bool IsOfSize(const BodyImage& body, const BodySize& size) {
  if (body.kind == core::BodyKind::kSphere) {
    return IsStatedLength(2.0 * body.radius_px.value, size.long_px);
  }
  return IsStatedLength(2.0 * body.half_long_px.value, size.long_px) &&
         IsStatedLength(2.0 * body.half_short_px.value, size.short_px);
}

bool CanStartFromLayers(const Clip& clip, const TrackOptions& options) {
  // Frames: every eighth is sampled then, and between two samples the body
  // moves by about its own size. In longer clips the start may miss it. Not
  // studied.
  constexpr std::int64_t kMaxFrames = 400;
  const std::int64_t last =
      options.last < 0 ? clip.info().frames : options.last;
  return options.region.width == 0 && last - options.first <= kMaxFrames &&
         clip.KnownChanges(options.first) == nullptr;
}

bool MayFollowGhost(const Clip& clip, const TrackOptions& options,
                    const Track& track, double most_covered) {
  if (!options.size || !options.kind || !CanStartFromLayers(clip, options)) {
    return false;
  }
  // Share of the time. The background is an interquartile mean: what covers a
  // pixel in more than three quarters of the samples is what it takes for
  // background. From that definition.
  constexpr double kMaxCovered = 0.75;
  // Share of the frames. A body that is seen at its stated size in so many is
  // no ghost. Larger costs time in clips that are right: with 0.9, 174 raw
  // clips took no more time than before (80 s instead of 86 s).
  constexpr double kSeenShare = 0.9;
  const auto seen = IsOfSize(track.body, *options.size)
                        ? std::count_if(track.poses.begin(), track.poses.end(),
                                        [&track](const Pose& pose) {
                                          return track.layered ||
                                                 pose.misfit <= kWellModelled;
                                        })
                        : 0;
  return most_covered > kMaxCovered ||
         static_cast<double>(seen * track.step) <
             kSeenShare *
                 static_cast<double>(track.last_frame - track.first_frame);
}

core::Expected<TrackResult> TrackFromLayers(Clip& clip,
                                            const TrackOptions& options,
                                            std::int64_t last,
                                            const Background& fallback) {
  LayeredStartOptions start_options;
  start_options.first = options.first;
  start_options.last = last;
  start_options.threads = options.threads;
  if (!options.size) {
    const auto start = FindKindAndSize(clip, options.kind, start_options);
    if (!start) return tl::unexpected(start.error());
    // px of the body. A fit of one of 586 x 142 px took more than four minutes.
    // Smaller: large bodies are not found without a size. Not studied.
    constexpr double kMostArea = 2e4;
    if (start->shape.long_side * start->shape.short_side > kMostArea) {
      return core::AbsentBecause(
          "what moves is too large to learn its picture");
    }
    TrackOptions sized = options;
    sized.kind = start->shape.kind;
    sized.size = SizeOfStart(start->shape);
    Track track = TrackOfStart(clip, sized, last, start->poses);
    // An outline of a ball is a circle whatever its face shows; that of a block
    // may be drawn to what its face shows.
    return sized.kind == core::BodyKind::kSphere
               ? FitOutlinesOfSize(clip, sized, std::move(track), fallback,
                                   {Size::kHeld, Size::kFree})
               : FitOutlinesOfSize(clip, sized, std::move(track), fallback,
                                   {Size::kHeld});
  }
  start_options.shape = MakeKnownShape(*options.kind, *options.size);
  const auto start = FindLayeredStart(clip, start_options);
  if (!start) return tl::unexpected(start.error());
  return FitOutlinesOfSize(clip, options,
                           TrackOfStart(clip, options, last, *start), fallback,
                           {Size::kHeld, Size::kFree, Size::kHeld});
}

}  // namespace touchdown::vision
