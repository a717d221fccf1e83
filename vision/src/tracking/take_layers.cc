#include "tracking/take_layers.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "touchdown/vision/explanation/explained_change.h"
#include "touchdown/vision/footage/linear_clip.h"
#include "tracking/follow_in_layers.h"
#include "tracking/layered_track.h"
#include "tracking/seen_shape.h"
#include "tracking/track_cover.h"

namespace touchdown::vision {
namespace {

// Of the change. More: tracks that are right are sought once more, which costs
// time only; less: a ghost's or a part's may be taken. Of 42 layered starts in
// clips of 25 scenes, all of which were right, the least explained 0.95; of
// photographed blocks whose size was not stated 0.98, of parts of one 0.7 at
// the most.
constexpr double kLeastExplained = 0.85;

// Of the change, by a right track of a block whose size nobody stated. More: a
// second fit, which costs time only; less: a wrong outline may be kept.
constexpr double kUsuallyExplained = 0.975;

// Of the change, by a rectangle that was taken for what is seen. Smaller keeps
// parts of blocks (one explained 0.94), larger loses right ones (0.96).
constexpr double kLeastOfSeen = 0.95;

// Of what outlines leave unexplained, by the block of which they are a part.
// Larger: a block's shadow is taken for its rest (which left 0.5 and 0.8),
// smaller: outlines that were led astray stay (of six the whole block left 0.04
// to 0.07).
constexpr double kLeftByTheRest = 0.3;

// The share of all that changes in the clip that a track explains
// (explained_change.h); 0 where it is not of the stated size.
double ShareExplained(Clip& clip, const TrackOptions& options,
                      const Track& track) {
  if (options.size && !IsOfSize(track.body, *options.size)) return 0.0;
  ExplainedChangeOptions change;
  change.still_frames = options.still_frames;
  change.threads = options.threads;
  const auto explained = MeasureExplainedChange(clip, track, change);
  return explained ? explained->OfAll() : 0.0;
}

// Measures a result again by the two-layer model.
core::Expected<TrackResult> InLayers(Clip& clip, const TrackOptions& options,
                                     TrackResult result) {
  auto track = FollowInLayers(clip, result.background, result.track,
                              options.size, options.threads);
  if (!track) return tl::unexpected(track.error());
  result.track = std::move(*track);
  if (const auto& gamma = result.track.body.gamma) {
    result.background = InLight(result.background,
                                MakeLightScale(clip.info().bit_depth, *gamma));
  }
  return result;
}

// The rectangle that is seen along a track's poses, and the background without
// it. Absent where it has no end.
core::Expected<TrackResult> LookAlongPoses(Clip& clip,
                                           const TrackOptions& options,
                                           const Track& track,
                                           const Background& fallback) {
  // Of the sides, beyond the outline: what it may have left out. More looks at
  // what stands beside the body. Not studied.
  constexpr double kMargin = 0.2;
  constexpr double kLeastMargin_px = 6.0;  // clear of the blur
  constexpr int kMostRounds = 4;           // twice the sides
  TrackResult out;
  out.track = track;
  for (int round = 0; round < kMostRounds; ++round) {
    Track wide = out.track;
    for (double* half :
         {&wide.body.half_long_px.value, &wide.body.half_short_px.value}) {
      *half += std::max(kMargin * *half, kLeastMargin_px);
    }
    out.background = EstimateUncovered(clip, options, wide, fallback);
    const auto seen = TakeSeenRectangle(clip, out.background, wide);
    if (!seen) return core::AbsentBecause("too little of the body is seen");
    out.track = seen->track;
    if (!seen->goes_on) return out;
  }
  return core::AbsentBecause("what is seen along the poses has no end");
}

// Layers from the rectangle that is seen along the poses of `layered`; all else
// is that of the outlines.
core::Expected<TrackResult> InSeenRectangle(Clip& clip,
                                            const TrackOptions& options,
                                            const TrackResult& layered,
                                            const TrackResult& outlines) {
  auto seen = LookAlongPoses(clip, options, layered.track, outlines.background);
  if (!seen) return seen;
  Track start = outlines.track;
  start.poses = std::move(seen->track.poses);
  start.body.half_long_px = seen->track.body.half_long_px;
  start.body.half_short_px = seen->track.body.half_short_px;
  seen->track = std::move(start);
  return InLayers(clip, options, std::move(*seen));
}

// A result of layers, and the share of the change that it explains.
struct Explained {
  TrackResult result;
  double share = 0.0;
};

// A block's outline that was led astray explains less than usual. While less
// than `enough` is explained, the rectangle that is seen is followed, and once
// more with better poses.
Explained ImproveOutline(Clip& clip, const TrackOptions& options,
                         const TrackResult& outlines, TrackResult layered,
                         double share, double enough) {
  constexpr int kMostRounds = 3;  // two were enough in the clips looked at
  Explained best{std::move(layered), share};
  for (int round = 0; round < kMostRounds && best.share < enough; ++round) {
    auto again = InSeenRectangle(clip, options, best.result, outlines);
    if (!again) break;
    const double then = ShareExplained(clip, options, again->track);
    if (then <= best.share) break;
    best = {std::move(*again), then};
  }
  return best;
}

// The sides that are seen along a track's poses. `behind`: a background in
// levels.
std::optional<SeenSides> LookAtSides(Clip& clip, const TrackOptions& options,
                                     const Track& track,
                                     const Background& behind) {
  constexpr double kMargin_px = 4.0;  // in which the edges are sought
  Track wide = track;
  for (double* half :
       {&wide.body.radius_px.value, &wide.body.half_long_px.value,
        &wide.body.half_short_px.value}) {
    *half += kMargin_px;
  }
  const Background still = EstimateUncovered(clip, options, wide, behind);
  const auto& gamma = track.body.gamma;
  if (!gamma) return MeasureSeenSides(clip, still, track);
  // Half of a difference in levels is not half of it in light.
  return MeasureSeenSides(
      *ViewInLight(clip, *gamma),
      InLight(still, MakeLightScale(clip.info().bit_depth, *gamma)), track);
}

// What layers tell of sides and what is seen of them differ by is part of their
// u: before a texture layers may settle on others.
void WidenSides(Clip& clip, const TrackOptions& options,
                const Background& behind, Track& track) {
  const auto seen = LookAtSides(clip, options, track, behind);
  if (!seen) return;
  // px of half a side, by which the two differ where layers are right: of 73
  // sides of photographed blocks eight in ten differ by less. Larger misses
  // what layers are off by; smaller widens u of right ones.
  constexpr double kUsual_px = 0.15;
  const auto beyond_usual = [](const core::Estimate& half, double other) {
    const double off = half.value - other;
    return std::sqrt(std::max(0.0, off * off - kUsual_px * kUsual_px));
  };
  BodyImage& body = track.body;
  if (body.kind == core::BodyKind::kSphere) {
    body.radius_px.u = std::hypot(
        body.radius_px.u, beyond_usual(body.radius_px, seen->half_long_px));
    return;
  }
  const double of_long = beyond_usual(body.half_long_px, seen->half_long_px);
  const double of_short = beyond_usual(body.half_short_px, seen->half_short_px);
  body.half_long_px.u = std::hypot(body.half_long_px.u, of_long);
  body.half_short_px.u = std::hypot(body.half_short_px.u, of_short);
  // A long side that is off at one end turns the body.
  body.u_common_angle_rad =
      std::hypot(body.u_common_angle_rad, of_short / body.half_long_px.value);
}

// Whether the body that is seen along the poses of layers is as large as was
// stated. Layers alone believe wrong sizes of a texture, and outlines of free
// size are led astray by it.
bool ShowsStatedSize(Clip& clip, const TrackOptions& options,
                     const Track& track, const Background& behind) {
  // px of half a side. Larger: wrong sizes are believed: stated 6 % too large
  // or small, one side at least was off by 0.49 or more, in 48 clips of 24
  // scenes. Smaller: starts that are right are refused (of 73 in photographed
  // and rendered clips the largest was 0.28, of 54 pictured ones 0.44).
  constexpr double kMost_px = 0.45;
  constexpr double kSigmas = 4.0;  // of the stated size
  const auto seen = LookAtSides(clip, options, track, behind);
  const auto is_stated = [](double half_px, const core::Estimate& side) {
    return std::abs(half_px - 0.5 * side.value) <=
           std::hypot(kMost_px, kSigmas * 0.5 * side.u);
  };
  return seen && is_stated(seen->half_long_px, options.size->long_px) &&
         (track.body.kind == core::BodyKind::kSphere ||
          is_stated(seen->half_short_px, options.size->short_px));
}

}  // namespace

core::Expected<TrackResult> StartInLayers(Clip& clip,
                                          const TrackOptions& options,
                                          std::int64_t last,
                                          const Background& fallback) {
  const auto started = TrackFromLayers(clip, options, last, fallback);
  if (!started) return tl::unexpected(started.error());
  auto layered = InLayers(clip, options, *started);
  if (layered && options.size &&
      !ShowsStatedSize(clip, options, layered->track, started->background)) {
    return core::AbsentBecause("the body that is seen is of another size");
  }
  return layered;
}

bool ExplainsClip(Clip& clip, const TrackOptions& options, const Track& track) {
  return ShareExplained(clip, options, track) >= kLeastExplained;
}

bool TakeLayers(Clip& clip, const TrackOptions& options, double most_covered,
                std::optional<core::Expected<TrackResult>> started,
                TrackResult& result) {
  core::Expected<TrackResult> best = core::AbsentBecause("not of the size");
  if (!options.size || IsOfSize(result.track.body, *options.size)) {
    best = InLayers(clip, options, result);
  }
  if (options.size &&
      MayFollowGhost(clip, options, best ? best->track : result.track,
                     most_covered)) {
    if (!started) {
      started = StartInLayers(clip, options, result.track.last_frame,
                              result.background);
    }
    // Of the change: what two tracks of one body differ by. Larger keeps a
    // ghost's. Not studied.
    constexpr double kNoise = 0.01;
    if (*started &&
        ShareExplained(clip, options, (*started)->track) >
            kNoise +
                (best ? ShareExplained(clip, options, best->track) : 0.0)) {
      best = std::move(*started);
    }
  }
  if (!options.size && best &&
      best->track.body.kind == core::BodyKind::kRectangle) {
    double share = ShareExplained(clip, options, best->track);
    if (share < kUsuallyExplained) {
      auto better = ImproveOutline(clip, options, result, *best, share,
                                   kUsuallyExplained);
      if (better.share > kLeastOfSeen &&
          1.0 - better.share < kLeftByTheRest * (1.0 - share)) {
        best = std::move(better.result);
        share = better.share;
      }
    }
    // What was followed may be a part of the block.
    if (share < kLeastExplained) return false;
    WidenSides(clip, options, result.background, best->track);
  }
  // Share of the outlines' frames that layers must keep. Smaller: frames are
  // lost for nothing; larger: a few bad frames refuse the better model. Not
  // studied.
  constexpr double kMinKeptShare = 0.9;
  if (!best ||
      static_cast<double>(best->track.poses.size()) <
          kMinKeptShare * static_cast<double>(result.track.poses.size())) {
    return false;
  }
  result = std::move(*best);
  return true;
}

bool TakeLayeredStart(Clip& clip, const TrackOptions& options,
                      std::int64_t last, TrackResult& result) {
  if (options.size || !CanStartFromLayers(clip, options) ||
      ShareExplained(clip, options, result.track) >= kLeastExplained) {
    return false;
  }
  auto outlines = TrackFromLayers(clip, options, last,
                                  EstimateFromAll(clip, options, last));
  if (!outlines) return false;
  auto layered = InLayers(clip, options, *outlines);
  if (!layered) return false;
  const double share = ShareExplained(clip, options, layered->track);
  Explained best{std::move(*layered), share};
  if (outlines->track.body.kind == core::BodyKind::kRectangle) {
    // The start's sides are known to a cell.
    best = ImproveOutline(clip, options, *outlines, std::move(best.result),
                          best.share, 1.0);
  }
  if (best.share < kLeastOfSeen) return false;
  WidenSides(clip, options, outlines->background, best.result.track);
  result = std::move(best.result);
  return true;
}

}  // namespace touchdown::vision
