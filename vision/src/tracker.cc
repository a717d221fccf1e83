#include "touchdown/vision/tracker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "chain.h"
#include "detect.h"
#include "touchdown/core/errors.h"
#include "track_shape.h"

namespace touchdown::vision {
namespace {

using Surround = OutlineOptions::Surround;

struct Found {
  std::vector<Chain> chains;
  std::int64_t last = 0;  // frames [first, last) could be read
  std::string warning;
};

Found Detect(Clip& clip, const Background& background,
             const TrackOptions& options, Detector detector,
             std::int64_t last) {
  DetectOptions detect;
  detect.detector = detector;
  detect.region = options.region;
  ChainBuilder builder;
  Found found;
  found.last = last;
  for (std::int64_t index = options.first; index < last; ++index) {
    try {
      const core::Frame frame = clip.Read(index);
      builder.Add(index, frame.time_s, DetectBlobs(frame, background, detect));
    } catch (const core::InputError& error) {
      if (index == options.first) throw;
      found.last = index;
      found.warning = fmt::format("frames from {} on cannot be read: {}", index,
                                  error.what());
      break;
    }
    if (options.progress) {
      options.progress(static_cast<double>(index - options.first) /
                       static_cast<double>(last - options.first));
    }
  }
  found.chains = builder.Finish();
  return found;
}

// How badly an outline explains the pixels: residuals over noise, dearer where
// many pixels had to be left out.
double Badness(const core::Expected<OutlineFit>& fit) {
  constexpr double kNoFit = 50.0;
  if (!fit) return kNoFit;
  return fit->misfit / std::max(0.05, fit->inliers * fit->inliers);
}

// What to fit and against what, with the evidence.
struct Choice {
  core::BodyKind kind = core::BodyKind::kSphere;
  double badness = 1e9;
  double blur_px = 0.8;
};

// Tries the kinds on a few frames spread over the chain, away from the border.
Choice ChooseKind(Clip& clip, const Background& background, const Chain& chain,
                  const TrackOptions& options, Surround surround) {
  constexpr std::size_t kProbes = 9;
  std::vector<const Link*> inside;
  for (const Link& link : chain.links) {
    if (!link.blob.at_border) inside.push_back(&link);
  }
  if (inside.empty()) {
    for (const Link& link : chain.links) inside.push_back(&link);
  }
  std::vector<const Link*> probes;
  const std::size_t n = std::min(kProbes, inside.size());
  for (std::size_t k = 0; k < n; ++k) {
    probes.push_back(inside[(2 * k + 1) * inside.size() / (2 * n)]);
  }
  std::vector<core::BodyKind> kinds = {core::BodyKind::kSphere,
                                       core::BodyKind::kRectangle};
  if (options.kind) kinds = {*options.kind};
  Choice best;
  for (const core::BodyKind kind : kinds) {
    std::vector<double> badness;
    std::vector<double> blur;
    for (const Link* link : probes) {
      OutlineOptions fit_options;
      fit_options.surround = surround;
      fit_options.ground = options.ground;
      const core::Frame frame = clip.Read(link->frame);
      const auto fit = FitOutline(frame, background,
                                  StartFrom(link->blob, kind), fit_options);
      badness.push_back(Badness(fit));
      if (fit) blur.push_back(fit->blur_px);
    }
    // The mean of the better half: a frame in contact or half hidden must not
    // decide.
    std::sort(badness.begin(), badness.end());
    badness.resize((badness.size() + 1) / 2);
    double sum = 0.0;
    for (const double b : badness) sum += b;
    const double mean = sum / static_cast<double>(badness.size());
    if (mean < best.badness) {
      best.badness = mean;
      best.kind = kind;
      best.blur_px = blur.empty() ? 0.8 : Median(blur);
    }
  }
  return best;
}

std::vector<Fitted> FitAll(Clip& clip, const Background& background,
                           const Chain& chain, const Choice& choice,
                           const TrackOptions& options, Surround surround) {
  std::vector<Fitted> all;
  OutlineOptions fit_options;
  fit_options.surround = surround;
  fit_options.ground = options.ground;
  fit_options.blur_px = choice.blur_px;
  for (const Link& link : chain.links) {
    const core::Frame frame = clip.Read(link.frame);
    auto fit = FitOutline(frame, background, StartFrom(link.blob, choice.kind),
                          fit_options);
    if (fit) all.push_back({link.frame, link.time_s, *fit});
  }
  return all;
}

// The first look: detection against a background that may hold the body's
// ghost.
struct Look {
  Background background;
  Found found;
  Choice choice;
  Surround surround = Surround::kBackground;
  std::vector<Fitted> fits;

  // Badness of the outlines; dearer where the body was seen in few frames.
  double Cost() const {
    if (found.chains.empty()) return std::numeric_limits<double>::infinity();
    return choice.badness /
           std::sqrt(static_cast<double>(found.chains.front().links.size()));
  }
  // Outlines fitted to a ghost's edge jump about, however well they fit: a
  // track of as many frames that is four times smoother is the body's.
  bool MuchSmootherThan(const Look& other) const {
    constexpr double kSmoother = 0.25;
    constexpr double kAsManyFrames = 0.9;
    return Roughness(fits) < kSmoother * Roughness(other.fits) &&
           static_cast<double>(fits.size()) >=
               kAsManyFrames * static_cast<double>(other.fits.size());
  }
};

Look LookWith(Clip& clip, Background background, const TrackOptions& options,
              Detector detector, std::int64_t last) {
  Look look;
  look.background = std::move(background);
  look.surround = detector == Detector::kDifference ? Surround::kBackground
                                                    : Surround::kPolynomial;
  look.found = Detect(clip, look.background, options, detector, last);
  if (!look.found.chains.empty()) {
    const Chain& chain = look.found.chains.front();
    look.choice =
        ChooseKind(clip, look.background, chain, options, look.surround);
    look.fits = FitAll(clip, look.background, chain, look.choice, options,
                       look.surround);
    DropStrangers(look.fits);
  }
  return look;
}

// A body that stays long where it is leaves its ghost in the mean of all
// frames, and outlines fit badly. Then the picture may be empty at the
// beginning, or at the end; where it never is, the frame's own two levels must
// do.
core::Expected<Look> FirstLook(Clip& clip, const TrackOptions& options,
                               std::int64_t last) {
  Look best = LookWith(clip, EstimateBackground(clip, options.first, last),
                       options, Detector::kDifference, last);
  constexpr double kWellFitted = 4.0;
  const std::int64_t part =
      std::max<std::int64_t>(3, (last - options.first) / 8);
  for (int attempt = 0; attempt < 3 && best.choice.badness > kWellFitted;
       ++attempt) {
    Background background = best.background;
    if (attempt == 0) {
      background = EstimateBackground(clip, options.first,
                                      std::min(options.first + part, last));
    } else if (attempt == 1) {
      background = EstimateBackground(
          clip, std::max(options.first, best.found.last - part),
          best.found.last);
    }
    Look look =
        LookWith(clip, std::move(background), options,
                 attempt == 2 ? Detector::kLevels : Detector::kDifference,
                 best.found.last);
    look.found.warning = best.found.warning;
    if (look.MuchSmootherThan(best) ||
        (look.Cost() < best.Cost() && !best.MuchSmootherThan(look))) {
      best = std::move(look);
    }
  }
  if (best.found.chains.empty()) {
    return core::AbsentBecause("nothing moves in these frames");
  }
  constexpr std::size_t kLeastFrames = 3;
  if (best.fits.size() < kLeastFrames) {
    return core::AbsentBecause(
        "something moves, but no outline of a sphere or rectangle fits it");
  }
  return best;
}

// The pose in a frame: measured, or between two measured ones; nothing outside
// the track.
std::optional<Pose> PoseIn(const Track& track, std::int64_t frame) {
  const auto after = std::lower_bound(
      track.poses.begin(), track.poses.end(), frame,
      [](const Pose& pose, std::int64_t f) { return pose.frame < f; });
  if (after == track.poses.end()) return std::nullopt;
  if (after->frame == frame) return *after;
  if (after == track.poses.begin()) return std::nullopt;
  const Pose& a = *(after - 1);
  const Pose& b = *after;
  const double share = static_cast<double>(frame - a.frame) /
                       static_cast<double>(b.frame - a.frame);
  Pose pose = a;
  pose.frame = frame;
  pose.centre.x_px += share * (b.centre.x_px - a.centre.x_px);
  pose.centre.y_px += share * (b.centre.y_px - a.centre.y_px);
  pose.angle_rad += share * (b.angle_rad - a.angle_rad);
  return pose;
}

// Mean level of a frame inside the outline, clear of its edge.
double LevelInside(const core::Frame& frame, const Outline& outline) {
  const double reach = outline.kind == core::BodyKind::kSphere
                           ? outline.radius_px
                           : outline.half_long_px;
  const double depth =
      0.3 * (outline.kind == core::BodyKind::kSphere ? outline.radius_px
                                                     : outline.half_short_px);
  double sum = 0.0;
  double count = 0.0;
  for (int y = static_cast<int>(outline.centre.y_px - reach);
       y <= static_cast<int>(outline.centre.y_px + reach); ++y) {
    for (int x = static_cast<int>(outline.centre.x_px - reach);
         x <= static_cast<int>(outline.centre.x_px + reach); ++x) {
      if (x < 0 || y < 0 || x >= frame.width_px || y >= frame.height_px) {
        continue;
      }
      if (DepthInside(outline, x, y) < depth) continue;
      sum += frame.at(x, y);
      count += 1.0;
    }
  }
  return count > 0.0 ? sum / count : 0.0;
}

// Before the track begins and after it ends the picture may be empty, or the
// body may rest where the track begins or ends, unmoved and so unseen. Empty
// frames are the best background there is.
class Absence {
 public:
  Absence(Clip& clip, const Track& track) : clip_(clip), track_(track) {
    const Pose& first = track.poses.front();
    const Pose& last = track.poses.back();
    level_first_ =
        LevelInside(clip.Read(first.frame), OutlineAt(track.body, first));
    level_last_ =
        LevelInside(clip.Read(last.frame), OutlineAt(track.body, last));
  }
  // True if `frame` lies outside the track and the body is not in it.
  bool Holds(std::int64_t frame) const {
    const Pose& first = track_.poses.front();
    const Pose& last = track_.poses.back();
    const bool before = frame < first.frame;
    if (!before && frame <= last.frame) return false;
    const double level = LevelInside(
        clip_.Read(frame), OutlineAt(track_.body, before ? first : last));
    return std::abs(level - (before ? level_first_ : level_last_)) >
           0.5 * std::abs(track_.body.contrast_dn);
  }

 private:
  Clip& clip_;
  const Track& track_;
  double level_first_ = 0.0;
  double level_last_ = 0.0;
};

// Marks what the body covers in `frame`, with a margin for blur, for the error
// of a first look and for the shadow's rim.
bool Cover(const Track& track, std::int64_t frame, const Background& background,
           std::vector<std::uint8_t>& mask) {
  const std::optional<Pose> pose = PoseIn(track, frame);
  if (!pose) return false;
  const Outline outline = OutlineAt(track.body, *pose);
  const double margin = 3.0 * track.body.blur_px + 3.0;
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
  for (int y = from(outline.centre.y_px);
       y <= to(outline.centre.y_px, background.height_px); ++y) {
    for (int x = from(outline.centre.x_px);
         x <= to(outline.centre.x_px, background.width_px); ++x) {
      if (DepthInside(outline, x, y) > -margin) {
        mask[static_cast<std::size_t>(y) *
                 static_cast<std::size_t>(background.width_px) +
             static_cast<std::size_t>(x)] = 1;
      }
    }
  }
  return true;
}

// Fits again from the track's own poses, in every frame of its stay.
std::vector<Fitted> FitFromTrack(Clip& clip, const Background& background,
                                 const Track& track,
                                 const TrackOptions& options, double blur_px) {
  std::vector<Fitted> all;
  OutlineOptions fit_options;
  fit_options.ground = options.ground;
  fit_options.blur_px = blur_px;
  for (std::int64_t f = track.poses.front().frame;
       f <= track.poses.back().frame; ++f) {
    const auto pose = PoseIn(track, f);
    const core::Frame frame = clip.Read(f);
    auto fit = FitOutline(frame, background, OutlineAt(track.body, *pose),
                          fit_options);
    if (fit) all.push_back({f, frame.time_s, *fit});
  }
  return all;
}

// The first frame of [first, last) that cannot be read, with the reason; `last`
// where all can.
std::int64_t FirstUnreadable(Clip& clip, std::int64_t first, std::int64_t last,
                             std::string& reason) {
  for (std::int64_t index = first; index < last; ++index) {
    try {
      clip.Read(index);
    } catch (const core::InputError& error) {
      reason = error.what();
      return index;
    }
  }
  return last;
}

}  // namespace

core::Expected<TrackResult> TrackBody(Clip& clip, const TrackOptions& options) {
  std::int64_t last = options.last < 0
                          ? clip.info().frames
                          : std::min(options.last, clip.info().frames);
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
  if (!first) return tl::unexpected(first.error());
  if (warning.empty()) warning = first->found.warning;
  result.background = std::move(first->background);

  Track& track = result.track;
  track.first_frame = options.first;
  track.last_frame = first->found.last;
  track.frame_interval_s = 1.0 / clip.info().time_base.fps;
  const Chain& chain = first->found.chains.front();
  for (std::size_t i = 1; i < first->found.chains.size(); ++i) {
    track.several_bodies |= IsAnotherBody(chain, first->found.chains[i]);
  }
  track.known_background = first->surround == Surround::kBackground;
  std::vector<Fitted> all = std::move(first->fits);
  FillTrack(all, first->choice.kind, track);

  // Now that the body's place is known, the background without it.
  double whole_px = 0.0;
  if (first->choice.kind == core::BodyKind::kRectangle) {
    for (std::size_t i = 1; i < first->found.chains.size(); ++i) {
      whole_px =
          std::max(whole_px, LengthTogether(chain, first->found.chains[i]));
    }
  }
  double most_covered = 0.0;
  const Absence absence(clip, track);
  Background behind = EstimateBackgroundBehind(
      clip, options.first, track.last_frame,
      [&](std::int64_t frame, std::vector<std::uint8_t>& mask) {
        return Cover(track, frame, result.background, mask) ||
               absence.Holds(frame);
      },
      result.background, {}, &most_covered);
  // Covered less than a fifth of the time, a pixel's mid-mean is untouched.
  constexpr double kUntouched = 0.2;
  if (most_covered > kUntouched || !track.known_background) {
    const Choice again =
        ChooseKind(clip, behind, chain, options, Surround::kBackground);
    if (again.badness < first->choice.badness || track.known_background) {
      std::swap(result.background, behind);
      std::vector<Fitted> better;
      if (again.kind == first->choice.kind) {
        better = FitFromTrack(clip, result.background, track, options,
                              again.blur_px);
      } else {
        better = FitAll(clip, result.background, chain, again, options,
                        Surround::kBackground);
      }
      DropStrangers(better);
      constexpr double kAsSmooth = 1.5;
      if (better.size() * 2 >= all.size() &&
          Roughness(better) <= kAsSmooth * Roughness(all) + 0.01) {
        track.known_background = true;
        track.warnings.clear();
        FillTrack(better, again.kind, track);
      } else {
        std::swap(result.background, behind);
      }
    }
  }
  if (!warning.empty()) track.warnings.push_back(warning);
  track.body.whole_px = whole_px;
  if (whole_px > 0.0) {
    track.warnings.push_back(fmt::format(
        "the body shows as parts that move as one ({:.0f} px together); the "
        "strongest part was followed",
        whole_px));
  }
  return result;
}

}  // namespace touchdown::vision
