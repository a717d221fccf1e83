#include "layered_track.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "body_cover.h"
#include "first_look.h"
#include "layered_start.h"
#include "outline_batch.h"
#include "track_shape.h"

namespace touchdown::vision {
namespace {

// A picture's size differs from the stated one by less where it is the same
// body: gamma and blur move both edges by half a pixel at most.
constexpr double kSameSize = 0.03;
constexpr double kStandardUncertainties = 4.0;

bool IsStatedLength(double found_px, const core::Estimate& stated) {
  return std::abs(found_px - stated.value) <=
         std::max(kStandardUncertainties * stated.u, kSameSize * stated.value);
}

KnownShape KnownShapeOf(core::BodyKind kind, const BodySize& size) {
  return {kind, size.long_px.value,
          kind == core::BodyKind::kSphere ? size.long_px.value
                                          : size.short_px.value};
}

// The start as a track of the stated size. Its blur is what the places lack:
// so much beyond the outline is not taken for background (BodyCover).
Track TrackOfStart(const Clip& clip, const TrackOptions& options,
                   std::int64_t last, const LayeredStart& start) {
  constexpr double kOff = 0.04;  // of the short side: a third of the margin
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
  body.blur_px = kOff * KnownShapeOf(body.kind, size).short_side;
  for (const StartPose& at : start.poses) {
    if (!at.seen) continue;
    Pose pose;
    pose.frame = at.frame;
    pose.centre = at.centre;
    pose.angle_rad = at.angle_rad;
    track.poses.push_back(pose);
  }
  return track;
}

// What a track's body leaves uncovered.
Background LookBehind(Clip& clip, const TrackOptions& options,
                      const Track& track, const Background& fallback) {
  const BodyCover cover(clip, track);
  const BackgroundOptions still = BackgroundFor(clip, options);
  const Covers covers = FindCovers(
      track.first_frame, track.last_frame,
      [&cover](std::int64_t frame) { return cover.In(frame); }, still);
  return EstimateBackgroundBehind(clip, covers, fallback, still);
}

// Outlines of all frames that the track reaches, from its own poses.
std::vector<Fitted> FitAlong(Clip& clip, const Background& background,
                             const TrackOptions& options, const Track& track,
                             const OutlineOptions& fit_options) {
  std::vector<OutlineJob> jobs;
  for (std::int64_t f = track.poses.front().frame;
       f <= track.poses.back().frame; ++f) {
    jobs.push_back({f, OutlineAt(track.body, *PoseIn(track, f))});
  }
  return Found(
      FitOutlines(clip, background, jobs, fit_options, options.threads));
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
  // Every eighth frame is then sampled: between two the body moves about its
  // own size.
  constexpr std::int64_t kMostFrames = 400;
  const std::int64_t last =
      options.last < 0 ? clip.info().frames : options.last;
  return options.size && options.kind && options.region.width == 0 &&
         last - options.first <= kMostFrames &&
         clip.ChangesIn(options.first) == nullptr;
}

bool IsTheBackground(double most_covered) {
  // The mid-mean is the mean of the middle half.
  constexpr double kMostCovered = 0.75;
  return most_covered > kMostCovered;
}

bool MayFollowGhost(const Clip& clip, const TrackOptions& options,
                    const Track& track, double most_covered) {
  if (!CanStartFromLayers(clip, options)) return false;
  // A body that is seen so in nine of ten frames is no ghost, and its clip
  // costs no more time.
  constexpr double kSeen = 0.9;
  const auto seen = IsOfSize(track.body, *options.size)
                        ? std::count_if(track.poses.begin(), track.poses.end(),
                                        [&track](const Pose& pose) {
                                          return track.layered ||
                                                 pose.misfit <= kWellModelled;
                                        })
                        : 0;
  return IsTheBackground(most_covered) ||
         static_cast<double>(seen * track.step) <
             kSeen * static_cast<double>(track.last_frame - track.first_frame);
}

double CountExplainedFrames(const Track& track, const BodySize& size) {
  if (!IsOfSize(track.body, size)) return 0.0;
  double count = 0.0;
  for (const Pose& pose : track.poses) {
    const double misfit = std::max(1.0, pose.misfit);
    count += 1.0 / (misfit * misfit);
  }
  return count;
}

core::Expected<TrackResult> TrackFromLayers(Clip& clip,
                                            const TrackOptions& options,
                                            std::int64_t last,
                                            const Background& fallback) {
  LayeredStartOptions start_options;
  start_options.first = options.first;
  start_options.last = last;
  start_options.shape = KnownShapeOf(*options.kind, *options.size);
  start_options.threads = options.threads;
  const auto start = FindLayeredStart(clip, start_options);
  if (!start) return tl::unexpected(start.error());

  TrackResult result;
  Track& track = result.track;
  track = TrackOfStart(clip, options, last, *start);
  constexpr std::size_t kLeast = 3;
  const auto too_few = [] {
    return core::AbsentBecause("too few outlines of the stated size");
  };
  if (track.poses.size() < kLeast) return too_few();
  // The stated size is held until the places are right; then the picture tells
  // it. Where the background is not known at one end of the body, a free size
  // draws the place along: at last the size of all frames is held.
  enum class Size { kStated, kFree, kCommon };
  for (const Size held : {Size::kStated, Size::kFree, Size::kCommon}) {
    result.background = LookBehind(clip, options, track, fallback);
    OutlineOptions fit_options;
    fit_options.ground = options.ground;
    fit_options.fit_size = held == Size::kFree;
    if (held != Size::kStated) fit_options.blur_px = track.body.blur_px;
    std::vector<Fitted> fits =
        FitAlong(clip, result.background, options, track, fit_options);
    std::erase_if(fits, [](const Fitted& f) { return !IsMeasured(f.fit); });
    DropStrangers(fits);
    // One frame tells its size less well than all of them.
    std::erase_if(fits, [&](const Fitted& f) {
      core::Estimate stated = options.size->long_px;
      stated.u = std::hypot(stated.u, 2.0 * f.fit.u_size_px);
      return !IsStatedLength(2.0 * SizeOf(f.fit), stated);
    });
    // What is lost by holding the size was better known without.
    constexpr double kMostLost = 0.2;
    if (held == Size::kCommon &&
        static_cast<double>(fits.size()) <
            (1.0 - kMostLost) * static_cast<double>(track.poses.size())) {
      break;
    }
    if (fits.size() < kLeast) return too_few();
    const BodyImage sized = track.body;
    track.warnings.clear();
    FillTrack(fits, *options.kind, track);
    // Held sizes have no u of their own.
    if (held == Size::kCommon) {
      track.body.radius_px = sized.radius_px;
      track.body.half_long_px = sized.half_long_px;
      track.body.half_short_px = sized.half_short_px;
    }
  }
  return result;
}

}  // namespace touchdown::vision
