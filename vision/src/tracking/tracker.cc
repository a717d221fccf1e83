#include "touchdown/vision/tracking/tracker.h"

#include <fmt/format.h>

#include <algorithm>
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
#include "tracking/whole_body.h"

namespace touchdown::vision {
namespace {

// Where the body should be: between two measured poses, or straight on from the
// ends of the track.
Pose ExpectedPose(const Track& track, std::int64_t frame) {
  if (const auto pose = InterpolatePose(track, frame)) return *pose;
  const auto& poses = track.poses;
  const bool before = frame < poses.front().frame;
  const Pose& end = before ? poses.front() : poses.back();
  const Pose& next = before ? poses[1] : poses[poses.size() - 2];
  return OnTheWay(end, next, frame);
}

// Fits again from the track's own poses.
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

// A rigid body has one size: an outline of another sits on another edge of it,
// such as the rim behind its face.
void DropOtherSizes(std::vector<Fitted>& all) {
  constexpr double kRatio = 1.05;
  std::vector<double> sizes;
  sizes.reserve(all.size());
  for (const Fitted& f : all) sizes.push_back(OutlineSize(f.fit));
  const double size = Median(std::move(sizes));
  std::erase_if(all, [&](const Fitted& f) {
    return OutlineSize(f.fit) > kRatio * size ||
           kRatio * OutlineSize(f.fit) < size;
  });
}

// Every `step`-th frame.
std::vector<std::int64_t> ListFrames(std::int64_t first, std::int64_t last,
                                     std::int64_t step) {
  std::vector<std::int64_t> frames;
  for (std::int64_t f = first; f <= last; f += step) frames.push_back(f);
  return frames;
}

OutlineOptions MakeFitOptions(const Track& track) {
  OutlineOptions fit_options;
  fit_options.surround =
      track.known_background ? Surround::kBackground : Surround::kPolynomial;
  fit_options.blur_px = track.body.blur_px;
  return fit_options;
}

// Where only every `step`-th frame was looked at, all frames now, and those at
// the ends that the looks may have missed. Returns a warning, or nothing.
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
  constexpr std::size_t kLeast = 8;
  if (all.size() >= track.poses.size() || (one_size && all.size() >= kLeast)) {
    track.warnings.clear();
    FillTrack(all, track.body.kind, track);
  }
  return warning;
}

// Frames within the track in which the outline was lost or sat on another edge:
// the body of one size is sought once more where the path leads.
void FitMissing(Clip& clip, const Background& background,
                const TrackOptions& options, Track& track) {
  if (track.step > 1 || !IsSteady(track)) return;
  std::vector<std::int64_t> missing;
  for (std::size_t i = 1; i < track.poses.size(); ++i) {
    for (std::int64_t f = track.poses[i - 1].frame + 1;
         f < track.poses[i].frame; ++f) {
      missing.push_back(f);
    }
  }
  if (missing.empty()) return;
  OutlineOptions fit_options = MakeFitOptions(track);
  fit_options.fit_size = false;
  // Twice as bad as usual is another thing; so is what is off the path.
  constexpr double kUsual = 2.0;
  constexpr double kOff = 0.1;  // of the body's size
  const double most_misfit = kUsual * MedianMisfit(track.poses);
  for (const Fitted& fit :
       FitFromTrack(clip, background, track, options, fit_options, missing)) {
    const Pose there = ExpectedPose(track, fit.frame);
    const double off =
        std::hypot(fit.fit.outline.centre.x_px - there.centre.x_px,
                   fit.fit.outline.centre.y_px - there.centre.y_px);
    if (!IsMeasured(fit.fit) || fit.fit.misfit > most_misfit ||
        fit.fit.hidden > kMostHidden ||
        off > kOff * 2.0 * OutlineSize(fit.fit)) {
      continue;
    }
    const auto at = std::lower_bound(
        track.poses.begin(), track.poses.end(), fit.frame,
        [](const Pose& pose, std::int64_t f) { return pose.frame < f; });
    track.poses.insert(at, ToPose(fit));
  }
  Unwrap(track);
}

// The same only where the path is not smooth, beside the `looks` that the track
// was made of; false, and nothing done, where the frames between do matter.
bool FitWhereNotSmooth(Clip& clip, const Background& background,
                       const TrackOptions& options, std::int64_t step,
                       const std::vector<Fitted>& looks, Track& track) {
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
  // A bridge needs its ends.
  if (!std::all_of(looks.begin(), looks.end(), is_there)) return false;
  Track filled = track;
  filled.warnings.clear();
  FillTrack(all, track.body.kind, filled);
  if (!IsSteady(filled)) return false;
  track = std::move(filled);
  track.step = step;
  return true;
}

// The track of a look's best chain. Warnings and the length of the whole come
// later.
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

Covers FindTrackCovers(Clip& clip, const TrackOptions& options,
                       const Track& track) {
  const BodyCover cover(clip, track);
  return FindCovers(
      options.first, track.last_frame,
      [&cover](std::int64_t frame) { return cover.CoverInFrame(frame); },
      ChooseBackgroundOptions(clip, options));
}

// Whether the body may have been lost where it passed its own ghost.
bool IsTorn(const Look& look) {
  constexpr double kMost = 0.9;  // of the links have an outline
  return look.found.chains.size() > 1 ||
         static_cast<double>(look.fits.size()) <
             kMost *
                 static_cast<double>(look.found.chains.front().links.size());
}

bool IsWellModelled(const Track& track) {
  return MedianMisfit(track.poses) <= kWellModelled;
}

// Where outlines explain the body badly (as badly as for its picture,
// follow_pattern.h: noise of compression is no part), it may be a part of what
// moves as one.
// Not a disc that stands out by its levels alone: what moves with a ball before
// an unknown background is its shadow. And not where a sphere was stated: its
// whole outline is the circle that was fitted.
void FollowWhole(Clip& clip, const TrackOptions& options, const Look& look,
                 TrackResult& result, double& whole_px) {
  Track& track = result.track;
  const bool ball_by_levels = track.body.kind == core::BodyKind::kSphere &&
                              look.surround != Surround::kBackground;
  const bool stated_ball = options.kind == core::BodyKind::kSphere;
  if (ball_by_levels || stated_ball || !(MedianMisfit(track.poses) > kCrude) ||
      !IsSteady(track) || look.found.step > 1) {
    return;
  }
  auto whole = FindWhole(clip, result.background, track, options);
  const Chain& chain = look.found.chains.front();
  constexpr double kFew = 0.5;  // of what was seen
  if (!whole && static_cast<double>(track.poses.size()) <
                    kFew * static_cast<double>(chain.links.size())) {
    whole = FindWhole(clip, result.background, MakePath(chain, track), options);
  }
  if (!whole) return;
  whole->known_background = true;
  whole->warnings.clear();
  whole->several_bodies = false;
  Background behind = EstimateMaskedBackground(
      clip, FindTrackCovers(clip, options, *whole), result.background,
      ChooseBackgroundOptions(clip, options));
  // What does not move as one picture was none.
  Track followed = FollowPattern(clip, behind, *whole, options.threads);
  if (!followed.patterned) return;
  track = std::move(followed);
  result.background = std::move(behind);
  whole_px = 0.0;
}

// Frames of the stated body that a result shows.
double CountExplained(const core::Expected<TrackResult>& result,
                      const TrackOptions& options) {
  return result ? CountExplainedFrames(result->track, *options.size) : 0.0;
}

// A result measured again by layers.
core::Expected<TrackResult> InLayers(Clip& clip, const TrackOptions& options,
                                     TrackResult result) {
  auto track = FollowInLayers(clip, result.background, result.track,
                              options.size, options.threads);
  if (!track) return tl::unexpected(track.error());
  result.track = std::move(*track);
  return result;
}

// The told body in two layers in place of the result's own outlines, from
// these or, where they may be those of a ghost, from a layered start.
bool TakeLayers(Clip& clip, const TrackOptions& options, double most_covered,
                TrackResult& result) {
  core::Expected<TrackResult> best = core::AbsentBecause("not of the size");
  if (!options.size || IsOfSize(result.track.body, *options.size)) {
    best = InLayers(clip, options, result);
  }
  if (options.size &&
      MayFollowGhost(clip, options, best ? best->track : result.track,
                     most_covered)) {
    auto started = TrackFromLayers(clip, options, result.track.last_frame,
                                   result.background);
    if (started) started = InLayers(clip, options, std::move(*started));
    // Equally good ones differ by noise. But where the body was part of the
    // background, a path that is drawn to its ghost explains as many frames.
    const double more = IsTheBackground(most_covered) ? 0.95 : 1.05;
    if (started && CountExplained(started, options) >
                       more * CountExplained(best, options)) {
      best = std::move(started);
    }
  }
  constexpr double kAsMany = 0.9;
  if (!best || static_cast<double>(best->track.poses.size()) <
                   kAsMany * static_cast<double>(result.track.poses.size())) {
    return false;
  }
  result = std::move(*best);
  return true;
}

core::Expected<TrackResult> FollowBody(Clip& clip,
                                       const TrackOptions& options) {
  std::int64_t last = options.last < 0
                          ? clip.info().frames
                          : std::min(options.last, clip.info().frames);
  const core::Cancellation& until = clip.cancellation();
  until.Enter("the body is looked for");
  TrackResult result;
  std::string warning;
  core::Expected<Look> first = core::AbsentBecause("not looked at");
  try {
    first = FirstLook(clip, options, last);
  } catch (const core::InputError&) {
    // The background's samples reach the damage first: look at what can be
    // read.
    std::string reason;
    last = FirstUnreadable(clip, options.first, last, reason);
    if (last == options.first) throw;
    warning = fmt::format("frames from {} on cannot be read: {}", last, reason);
    first = FirstLook(clip, options, last);
  }
  if (!first) {
    if (!CanStartFromLayers(clip, options)) {
      return tl::unexpected(first.error());
    }
    auto layered = TrackFromLayers(
        clip, options, last,
        EstimateBackground(clip, options.first, last,
                           ChooseBackgroundOptions(clip, options)));
    if (!layered) return tl::unexpected(first.error());
    if (auto followed = InLayers(clip, options, *layered)) layered = followed;
    if (!warning.empty()) layered->track.warnings.push_back(warning);
    return layered;
  }
  if (warning.empty()) warning = first->found.warning;

  until.Enter("the background behind the body is estimated");
  Track& track = result.track;
  track = MakeTrack(*first, clip, options);
  // Now that the body's place is known, the background without it.
  Covers covers = FindTrackCovers(clip, options, track);
  const auto look_behind = [&](Background fallback) {
    return EstimateMaskedBackground(clip, covers, std::move(fallback),
                                    ChooseBackgroundOptions(clip, options));
  };
  // Mostly that with the body is not needed again.
  const bool once = covers.most <= kUntouched && track.known_background &&
                    IsWellModelled(track);
  Background behind =
      look_behind(once ? std::move(first->background) : first->background);
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
  result.background = once ? std::move(behind) : std::move(first->background);
  const Chain& chain = first->found.chains.front();
  double whole_px = 0.0;
  if (first->choice.kind == core::BodyKind::kRectangle) {
    for (std::size_t i = 1; i < first->found.chains.size(); ++i) {
      whole_px =
          std::max(whole_px, LengthTogether(chain, first->found.chains[i]));
    }
  }
  if (covers.most > kUntouched || !track.known_background) {
    const Choice again =
        ChooseKind(clip, behind, chain, options, Surround::kBackground);
    if (again.badness < first->choice.badness || track.known_background) {
      std::swap(result.background, behind);
      // So many fits must not get lost.
      const auto enough = [&](const std::vector<Fitted>& fits) {
        return fits.size() * 2 >= first->fits.size();
      };
      std::vector<Fitted> better;
      if (again.kind == first->choice.kind) {
        OutlineOptions fit_options;
        fit_options.blur_px = again.blur_px;
        better = FitFromTrack(
            clip, result.background, track, options, fit_options,
            ListFrames(track.poses.front().frame, track.poses.back().frame,
                       first->found.step));
      }
      // From the blobs, if the track's outlines are those of the ghost.
      if (!enough(better)) {
        better = FitChain(clip, result.background, chain, again, options,
                          Surround::kBackground);
      }
      DropStrangers(better);
      constexpr double kAsSmooth = 1.5;
      if (enough(better) &&
          Roughness(better) <= kAsSmooth * Roughness(first->fits) + 0.01) {
        track.known_background = true;
        track.warnings.clear();
        FillTrack(better, again.kind, track);
        first->fits = std::move(better);
      } else {
        std::swap(result.background, behind);
      }
    }
  } else if (!once && IsWellModelled(track)) {
    // A body of another shape would show through its mask.
    result.background = std::move(behind);
  }
  until.Enter("outlines are fitted");
  // Now the frames between say where each fit begins. From rough starts, what
  // that finds is a better beginning again.
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
  // Of a ball the outline is a circle whatever it shows; of a block it must be
  // known that what was followed is the whole of it.
  const bool is_told =
      options.size ||
      (options.measured && options.kind == core::BodyKind::kSphere);
  if (is_told && NeedsLayers(track, covers.most) &&
      TakeLayers(clip, options, covers.most, result)) {
    whole_px = 0.0;
  } else {
    FitMissing(clip, result.background, options, track);
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
  if (result) result->track.is_predicted = clip.info().is_predicted;
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
  if (!cut.empty()) whole.warnings.push_back(cut);
  whole.warnings.insert(whole.warnings.end(), track.warnings.begin(),
                        track.warnings.end());
  return whole;
}

}  // namespace touchdown::vision
