#include "touchdown/vision/tracking/tracker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "detection/first_look.h"
#include "numbers/robust.h"
#include "outline/body_cover.h"
#include "outline/outline_batch.h"
#include "touchdown/core/errors.h"
#include "track/image_size.h"
#include "tracking/between_looks.h"
#include "tracking/follow_in_layers.h"
#include "tracking/follow_pattern.h"
#include "tracking/layered_track.h"
#include "tracking/take_layers.h"
#include "tracking/track_cover.h"
#include "tracking/unknown_gamma.h"
#include "tracking/whole_body.h"

namespace touchdown::vision {
namespace {

// Where the body should be in a frame: interpolated between two measured poses,
// or extrapolated along a straight line from the ends of the track.
Pose ExpectedPose(const Track& track, std::int64_t frame) {
  if (const auto pose = InterpolatePose(track, frame)) return *pose;
  const auto& poses = track.poses;
  const bool before = frame < poses.front().frame;
  const Pose& end = before ? poses.front() : poses.back();
  const Pose& next = before ? poses[1] : poses[poses.size() - 2];
  return OnTheWay(end, next, frame);
}

// Fits outlines again, each fit started from the pose that the track expects.
std::vector<Fitted> FitFromTrack(Clip& clip, const Background& background,
                                 const Track& track,
                                 const TrackOptions& options,
                                 OutlineOptions fit_options,
                                 const std::vector<std::int64_t>& frames) {
  fit_options.ground = options.ground;
  std::vector<OutlineJob> jobs;
  jobs.reserve(frames.size());
  for (const std::int64_t f : frames) {
    jobs.push_back({f, PlaceOutline(track.body, ExpectedPose(track, f))});
  }
  return Found(
      FitOutlines(clip, background, jobs, fit_options, options.threads));
}

// Rejects outlines of another size than the median: a rigid body has one size,
// and an outline of another sits on another edge of it, such as the rim behind
// its face.
void DropOtherSizes(std::vector<Fitted>& all) {
  // Ratio of a size to the median. Larger: outlines of a rim stay; smaller:
  // honest outlines of a small body go. Set with the recorded hoops, whose face
  // and rim differ by more.
  constexpr double kMaxSizeRatio = 1.05;
  std::vector<double> sizes;
  sizes.reserve(all.size());
  for (const Fitted& f : all) sizes.push_back(OutlineSize(f.fit));
  const double size = Median(std::move(sizes));
  std::erase_if(all, [&](const Fitted& f) {
    return OutlineSize(f.fit) > kMaxSizeRatio * size ||
           kMaxSizeRatio * OutlineSize(f.fit) < size;
  });
}

// Every `step`-th frame.
std::vector<std::int64_t> ListFrames(std::int64_t first, std::int64_t last,
                                     std::int64_t step) {
  std::vector<std::int64_t> frames;
  for (std::int64_t f = first; f <= last; f += step) frames.push_back(f);
  return frames;
}

// The pixels around the outline are the background's where that is known, else
// a polynomial.
OutlineOptions MakeFitOptions(const Track& track) {
  OutlineOptions fit_options;
  fit_options.surround =
      track.known_background ? Surround::kBackground : Surround::kPolynomial;
  fit_options.blur_px = track.body.blur_px;
  return fit_options;
}

// Fits all frames where so far only every `step`-th frame was fitted, and those
// at the ends that the coarse sampling may have missed. Returns a warning, or
// nothing.
std::string FitSkippedFrames(Clip& clip, const Background& background,
                             const TrackOptions& options, std::int64_t step,
                             bool one_size, Track& track) {
  const OutlineOptions fit_options = MakeFitOptions(track);
  const std::int64_t first =
      std::max(options.first, track.poses.front().frame - step + 1);
  const std::int64_t last =
      std::min(track.last_frame - 1, track.poses.back().frame + step - 1);
  std::string warning;
  std::vector<Fitted> all;
  try {
    all = FitFromTrack(clip, background, track, options, fit_options,
                       ListFrames(first, last, 1));
    // A damaged file: the track ends at the first frame that cannot be read,
    // with a warning, rather than be lost.
  } catch (const core::InputError&) {
    std::string reason;
    const std::int64_t bad = FirstUnreadable(clip, first, last + 1, reason);
    warning = fmt::format("frames from {} on cannot be read: {}", bad, reason);
    track.last_frame = bad;
    all = FitFromTrack(clip, background, track, options, fit_options,
                       ListFrames(first, bad - 1, 1));
  }
  DropStrangers(all);
  if (one_size) DropOtherSizes(all);
  // Frames. With one size asked for, fewer fits than poses are taken if they
  // are at least so many: the others sat on another edge. Not studied.
  constexpr std::size_t kMinOneSize = 8;
  if (all.size() >= track.poses.size() ||
      (one_size && all.size() >= kMinOneSize)) {
    track.warnings.clear();
    FillTrack(all, track.body.kind, track);
  }
  return warning;
}

// Fits the frames between coarse samples only where the path is not smooth
// (between_looks.h); Refine starts the others on the cubic. `looks`: the
// outlines that the track was made of. Returns false, and does nothing, where
// the frames between are needed.
bool FitWhereNotSmooth(Clip& clip, const Background& background,
                       const TrackOptions& options, std::int64_t step,
                       const std::vector<Fitted>& looks, Track& track) {
  // A body whose size changes needs all frames: each tells its own.
  if (!track.known_background || !IsSteady(track) || MayChangeSize(looks)) {
    return false;
  }
  const std::vector<bool> bridged = CanBeBridged(looks, track.poses, step);
  if (std::find(bridged.begin(), bridged.end(), true) == bridged.end()) {
    return false;
  }
  std::vector<std::int64_t> frames =
      ListFrames(std::max(options.first, looks.front().frame - step + 1),
                 looks.front().frame - 1, 1);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (bridged[i]) continue;
    const std::int64_t next =
        i + 1 < looks.size()
            ? looks[i + 1].frame
            : std::min(track.last_frame, looks[i].frame + step);
    for (std::int64_t f = looks[i].frame + 1; f < next; ++f) {
      frames.push_back(f);
    }
  }
  std::vector<Fitted> all = FitFromTrack(clip, background, track, options,
                                         MakeFitOptions(track), frames);
  all.insert(all.end(), looks.begin(), looks.end());
  std::sort(all.begin(), all.end(),
            [](const Fitted& a, const Fitted& b) { return a.frame < b.frame; });
  DropStrangers(all);
  const auto is_there = [&](const Fitted& look) {
    return std::binary_search(
        all.begin(), all.end(), look,
        [](const Fitted& a, const Fitted& b) { return a.frame < b.frame; });
  };
  // Interpolation needs both ends of each gap.
  if (!std::all_of(looks.begin(), looks.end(), is_there)) return false;
  Track filled = track;
  filled.warnings.clear();
  FillTrack(all, track.body.kind, filled);
  if (!IsSteady(filled)) return false;
  track = std::move(filled);
  track.step = step;
  return true;
}

// Makes the track of a hypothesis's strongest tracklet. Warnings, and the
// length of the whole, come later.
Track MakeTrack(const Look& look, const Clip& clip,
                const TrackOptions& options) {
  Track track;
  track.first_frame = options.first;
  track.last_frame = look.found.last;
  track.frame_interval_s = 1.0 / clip.info().time_base.fps;
  const Chain& chain = look.found.chains.front();
  for (std::size_t i = 1; i < look.found.chains.size(); ++i) {
    track.several_bodies |= IsAnotherBody(chain, look.found.chains[i]);
  }
  track.known_background = look.surround == Surround::kBackground;
  FillTrack(look.fits, look.choice.kind, track);
  return track;
}

// Whether the body may have been lost where it passed its own ghost: where a
// body is in the background's samples often, the estimated background shows it
// faintly, and a difference to that background is small.
bool IsTorn(const Look& look) {
  // Share of the detections that have an outline. Larger repeats the search in
  // clips that are right, at the cost of time only. Not studied.
  constexpr double kWholeShare = 0.9;
  return look.found.chains.size() > 1 ||
         static_cast<double>(look.fits.size()) <
             kWholeShare *
                 static_cast<double>(look.found.chains.front().links.size());
}

// Whether outlines explain the pixels to about their noise.
bool IsWellModelled(const Track& track) {
  return MedianMisfit(track.poses) <= kWellModelled;
}

// Where outlines explain the body badly, what was followed may be a part of
// what moves as one: the whole is sought and followed by its template
// (follow_pattern.h has the limit, which compression noise does not reach). Not
// for a disc that stands out by its levels alone: what moves with a ball before
// an unknown background is its shadow. Not where a sphere was stated: its whole
// outline is the circle that was fitted. Nor where the track explains the clip.
void FollowWhole(Clip& clip, const TrackOptions& options, const Look& look,
                 TrackResult& result, double& whole_px) {
  Track& track = result.track;
  const bool ball_by_levels = track.body.kind == core::BodyKind::kSphere &&
                              look.surround != Surround::kBackground;
  const bool stated_ball = options.kind == core::BodyKind::kSphere;
  if (ball_by_levels || stated_ball || !(MedianMisfit(track.poses) > kCrude) ||
      !IsSteady(track) || look.found.step > 1 ||
      ExplainsClip(clip, options, track)) {
    return;
  }
  auto whole = FindWhole(clip, result.background, track, options);
  const Chain& chain = look.found.chains.front();
  // Share of the detections that have a pose. With fewer poses the path of the
  // blobs is tried, too. Not studied.
  constexpr double kFewPoses = 0.5;
  if (!whole && static_cast<double>(track.poses.size()) <
                    kFewPoses * static_cast<double>(chain.links.size())) {
    whole = FindWhole(clip, result.background, MakePath(chain, track), options);
  }
  if (!whole) return;
  whole->known_background = true;
  whole->warnings.clear();
  whole->several_bodies = false;
  Background behind =
      EstimateUncovered(clip, options, *whole, result.background);
  // What cannot be followed as one picture does not move as one: the candidate
  // is discarded.
  Track followed = FollowPattern(clip, behind, *whole, options.threads);
  if (!followed.patterned) return;
  track = std::move(followed);
  result.background = std::move(behind);
  whole_px = 0.0;
}

// Before the background without the body, `behind`: the kind of the body and
// its outlines once more where the background that it was found before held it,
// or was not known, and may have misled the choice. Kept, with `behind` as the
// result's background, if enough outlines are as smooth.
void ChooseBehind(Clip& clip, const TrackOptions& options, double most_covered,
                  Background behind, Look& first, TrackResult& result) {
  Track& track = result.track;
  const Chain& chain = first.found.chains.front();
  if (most_covered <= kUntouched && track.known_background) {
    // A body of another shape would show through its mask.
    if (IsWellModelled(track)) result.background = std::move(behind);
    return;
  }
  const Choice again =
      ChooseKind(clip, behind, chain, options, Surround::kBackground);
  if (again.badness >= first.choice.badness && !track.known_background) return;
  // At least half of the outlines must remain.
  const auto enough = [&](const std::vector<Fitted>& fits) {
    return fits.size() * 2 >= first.fits.size();
  };
  std::vector<Fitted> better;
  if (again.kind == first.choice.kind) {
    OutlineOptions fit_options;
    fit_options.blur_px = again.blur_px;
    better =
        FitFromTrack(clip, behind, track, options, fit_options,
                     ListFrames(track.poses.front().frame,
                                track.poses.back().frame, first.found.step));
  }
  // The track's outlines may be those of the ghost: start from the blobs.
  if (!enough(better)) {
    better =
        FitChain(clip, behind, chain, again, options, Surround::kBackground);
  }
  DropStrangers(better);
  // Ratio of position noise (plus 0.01 px, below which it says nothing). The
  // new background is right in itself, so that a little more noise is allowed.
  // Set with the recorded ball_12bit.
  constexpr double kMaxNoiseRatio = 1.5;
  if (!enough(better) ||
      Roughness(better) > kMaxNoiseRatio * Roughness(first.fits) + 0.01) {
    return;
  }
  result.background = std::move(behind);
  track.known_background = true;
  track.warnings.clear();
  FillTrack(better, again.kind, track);
  first.fits = std::move(better);
}

// From frames to a track, in this order: where the clip is decoded whole, a
// layered start of a stated body, which ends the search if it explains the
// clip; the first hypothesis (detection); where it explains a stated body
// badly, a layered start, as before; the other hypotheses, the background
// without the body, the same hypothesis before that background where the body
// was lost, the kind of body once more, outlines of all frames, and at last
// layers, a layered start without a size, or a template where outlines do not
// explain the body.
core::Expected<TrackResult> FollowBody(Clip& clip,
                                       const TrackOptions& options) {
  std::int64_t last = options.last < 0
                          ? clip.info().frames
                          : std::min(options.last, clip.info().frames);
  const core::Cancellation& until = clip.cancellation();
  until.Enter("the body is looked for");
  TrackResult result;
  std::string warning;
  // Of a damaged file what can be read is looked at.
  const auto look = [&](const auto& once) {
    try {
      once();
    } catch (const core::InputError&) {
      std::string reason;
      last = FirstUnreadable(clip, options.first, last, reason);
      if (last == options.first) throw;
      warning =
          fmt::format("frames from {} on cannot be read: {}", last, reason);
      once();
    }
  };
  std::optional<core::Expected<TrackResult>> layered;
  const auto explains_clip = [&] {
    return *layered && ExplainsClip(clip, options, (*layered)->track);
  };
  const auto as_answer = [&] {
    if (!warning.empty()) (*layered)->track.warnings.push_back(warning);
    return std::move(*layered);
  };
  // A clip that is decoded whole is looked at in layers at once: in 13 clips in
  // H.264 (crf 23) a plain look cost as much as the start, 4.1 ms a frame.
  const bool starts_in_layers =
      options.size && options.kind && CanStartFromLayers(clip, options);
  if (starts_in_layers && !clip.windows_are_cheap()) {
    look([&] {
      layered = StartInLayers(clip, options, last,
                              EstimateFromAll(clip, options, last));
    });
    if (explains_clip()) return as_answer();
    until.Enter("the body is looked for");
  }
  Look plain;
  look([&] { plain = LookPlainly(clip, options, last); });
  if (warning.empty()) warning = plain.found.warning;
  // Cost of the plain look's outlines, about their residuals over the noise,
  // above which layers go first. 1.5: as many clips get slower as faster; 4:
  // outlines of all frames are fitted in vain, for 6 to 8 % more time.
  constexpr double kMaxPlainCost = 2.0;
  if (!layered && plain.choice.badness > kMaxPlainCost && starts_in_layers) {
    layered = StartInLayers(clip, options, plain.found.last, plain.background);
    if (explains_clip()) return as_answer();
    until.Enter("the body is looked for");
  }
  // Other backgrounds are made of other frames, which may be damaged.
  core::Expected<Look> first = core::AbsentBecause("not looked at");
  const std::int64_t seen = plain.found.last;
  look([&] {
    if (last < seen) plain = LookPlainly(clip, options, last);
    first = FirstLook(clip, options, std::move(plain));
  });
  if (!first) {
    if (TakeLayeredStart(clip, options, last, result)) {
      if (!warning.empty()) result.track.warnings.push_back(warning);
      return result;
    }
    // One that was tried already does not explain the clip.
    if (layered || !starts_in_layers) return tl::unexpected(first.error());
    layered = StartInLayers(clip, options, last,
                            EstimateFromAll(clip, options, last));
    if (!explains_clip()) return tl::unexpected(first.error());
    return as_answer();
  }

  until.Enter("the background behind the body is estimated");
  Track& track = result.track;
  track = MakeTrack(*first, clip, options);
  // The body's place is known now: the background is estimated without it.
  Covers covers = FindTrackCovers(clip, options, track);
  const auto look_behind = [&](Background fallback) {
    return EstimateMaskedBackground(clip, covers, std::move(fallback),
                                    ChooseBackgroundOptions(clip, options));
  };
  // In most clips the body covers no pixel often, and the background that it
  // was found before is not needed again: its memory is given away.
  const bool once = covers.most <= kUntouched && track.known_background &&
                    IsWellModelled(track);
  Background behind =
      look_behind(once ? std::move(first->background) : first->background);
  // The body was in the background often, and may have been lost there: once
  // more before the background without it. It must find more frames than
  // before.
  if (covers.most > kUntouched && IsTorn(*first)) {
    const auto more = static_cast<double>(first->fits.size() + 1);
    Look again = TryHypothesis(clip, behind, options, Detector::kDifference,
                               first->found.last, &*first, more);
    if (static_cast<double>(again.fits.size()) >= more &&
        IsBetter(again, *first)) {
      *first = std::move(again);
      track = MakeTrack(*first, clip, options);
      covers = FindTrackCovers(clip, options, track);
      behind = look_behind(first->background);
    }
  }
  if (once) {
    result.background = std::move(behind);
  } else {
    result.background = std::move(first->background);
    ChooseBehind(clip, options, covers.most, std::move(behind), *first, result);
  }
  const Chain& chain = first->found.chains.front();
  double whole_px = 0.0;
  if (first->choice.kind == core::BodyKind::kRectangle) {
    for (std::size_t i = 1; i < first->found.chains.size(); ++i) {
      whole_px =
          std::max(whole_px, LengthTogether(chain, first->found.chains[i]));
    }
  }
  until.Enter("outlines are fitted");
  // The frames between tell where each fit begins. After rough starts the
  // outlines that one pass finds are better starts for a second.
  int passes = first->rough_starts ? 2 : first->found.step > 1 ? 1 : 0;
  if (passes == 1 && !options.every_frame && clip.windows_are_cheap() &&
      FitWhereNotSmooth(clip, result.background, options, first->found.step,
                        first->fits, track)) {
    passes = 0;
  }
  for (int pass = 0; pass < passes && track.poses.size() > 1; ++pass) {
    const std::string cut =
        FitSkippedFrames(clip, result.background, options, first->found.step,
                         first->rough_starts && pass + 1 == passes, track);
    if (!cut.empty()) warning = cut;
  }
  // Sizes that nobody told are those of outlines, as long as these explain the
  // pictures once highlights and occluders are known, of which a texture tells
  // less; an outline of a ball is a circle whatever its face shows.
  const bool is_told =
      options.size ||
      (options.measured && options.kind == core::BodyKind::kSphere);
  const bool needs_layers =
      is_told
          ? NeedsLayers(track, covers.most) ||
                (options.size && !IsOfSize(track.body, *options.size)) ||
                ShowsMarks(clip, result.background, track)
          : track.body.kind == core::BodyKind::kRectangle &&
                !HasPlainFace(clip, result.background, track, options.threads);
  const bool is_layered =
      (needs_layers &&
       TakeLayers(clip, options, covers.most, std::move(layered), result)) ||
      (IsBadlyModelled(track) && TakeLayeredStart(clip, options, last, result));
  if (is_layered) {
    whole_px = 0.0;
  } else {
    FollowWhole(clip, options, *first, result, whole_px);
    if (!track.patterned) {
      track = FollowPattern(clip, result.background, track, options.threads);
    }
  }
  if (!warning.empty()) track.warnings.push_back(warning);
  track.warnings.insert(track.warnings.end(), first->found.bounds.begin(),
                        first->found.bounds.end());
  track.body.whole_px = whole_px;
  if (whole_px > 0.0) {
    track.warnings.push_back(fmt::format(
        "the body shows as parts that move as one ({:.0f} px together); the "
        "strongest part was followed",
        whole_px));
  }
  return result;
}

}  // namespace

core::Expected<TrackResult> TrackBody(Clip& clip, const TrackOptions& options) {
  core::Expected<TrackResult> result = FollowBody(clip, options);
  if (!result) return result;
  result->track.is_predicted = clip.info().is_predicted;
  if (!options.size) {
    TakeUnknownGamma(clip.info(), result->background, result->track);
  }
  return result;
}

Track FitEveryFrame(Clip& clip, const Background& background,
                    const Track& track, const TrackOptions& options) {
  Track whole = track;
  if (track.step <= 1) return whole;
  clip.cancellation().Enter("outlines are fitted");
  whole.step = 1;
  whole.warnings.clear();
  const std::string cut =
      FitSkippedFrames(clip, background, options, track.step, false, whole);
  whole.body.whole_px = track.body.whole_px;
  if (!options.size) TakeUnknownGamma(clip.info(), background, whole);
  if (!cut.empty()) whole.warnings.push_back(cut);
  whole.warnings.insert(whole.warnings.end(), track.warnings.begin(),
                        track.warnings.end());
  return whole;
}

}  // namespace touchdown::vision
