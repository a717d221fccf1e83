#include "detection/first_look.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "detection/watcher.h"
#include "footage/read_apart.h"
#include "numbers/robust.h"
#include "outline/outline_batch.h"
#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

struct Range {
  std::int64_t first = 0;
  std::int64_t last = 0;
};

// Which of every `step`-th frame of the range to look at: those within four
// sparse probes of one that saw a change. All, where no probe did.
std::vector<bool> WorthALook(Clip& clip, const Watcher& watcher,
                             const Range& range, std::int64_t step,
                             const TrackOptions& options) {
  const auto count =
      static_cast<std::size_t>((range.last - range.first + step - 1) / step);
  std::vector<bool> worth(count, true);
  if (!watcher.CanGlimpse(clip)) return worth;
  // Probes whose rows together are those of a full look: each probe reads every
  // fourth of them.
  constexpr std::size_t kPhases = 4;
  // Frames between probes. Larger reads less, and misses what is in view for
  // less time. Set with the benchmark of raw clips (1.14 -> 0.55 of `cat`).
  constexpr std::int64_t kMaxProbeStep = 32;
  const std::int64_t stride = std::clamp(
      (range.last - range.first) / options.first_looks, step, kMaxProbeStep);
  std::vector<char> glimpsed(static_cast<std::size_t>(
      (range.last - range.first + stride - 1) / stride));
  const auto glimpse = [&](Clip& reader, std::size_t k) {
    glimpsed[k] = watcher.Glimpse(
        reader, range.first + static_cast<std::int64_t>(k) * stride,
        static_cast<int>(k % kPhases));
  };
  if (CanReadApart(clip)) {
    ReadApart(clip, glimpsed.size(), options.threads, glimpse);
  } else {
    for (std::size_t k = 0; k < glimpsed.size(); ++k) glimpse(clip, k);
  }
  std::vector<bool> seen(count, false);
  for (std::size_t k = 0; k < glimpsed.size(); ++k) {
    if (!glimpsed[k]) continue;
    const std::int64_t index =
        range.first + static_cast<std::int64_t>(k) * stride;
    const std::int64_t reach = static_cast<std::int64_t>(kPhases) * stride;
    const std::int64_t from = std::max<std::int64_t>(
        0, (index - reach - range.first + step - 1) / step);
    const auto to = std::min(
        count,
        static_cast<std::size_t>((index + reach - range.first) / step) + 1);
    std::fill(seen.begin() + static_cast<std::ptrdiff_t>(from),
              seen.begin() + static_cast<std::ptrdiff_t>(to), true);
  }
  const bool any =
      std::any_of(seen.begin(), seen.end(), [](bool s) { return s; });
  return any ? seen : worth;
}

// Warnings of bounds that were met: in `more` of `looks` frames there was more
// to follow than is kept, and `left_out` tracklets were too many.
std::vector<std::string> BoundsMet(std::size_t more, std::size_t looks,
                                   std::size_t left_out) {
  // Share of the frames. In fewer the bound costs a tracklet a detection here
  // and there, as an occlusion does, and no warning is given. Not studied.
  constexpr double kMinToldShare = 0.1;
  std::vector<std::string> bounds;
  if (static_cast<double>(more) > kMinToldShare * static_cast<double>(looks)) {
    bounds.push_back(fmt::format(
        "in {} of {} frames looked at more than {} things move: the strongest "
        "were followed; give --region X,Y,W,H if the body is not among them",
        more, looks, DetectOptions{}.most_blobs));
  }
  if (left_out > 0) {
    bounds.push_back(fmt::format(
        "{} paths of things that move were left out, beyond the {} strongest; "
        "give --region X,Y,W,H or --frames A:B",
        left_out, LinkOptions{}.most_chains));
  }
  return bounds;
}

// Detects and links in every `step`-th frame of the range. `seen` receives the
// range in which anything was seen. `first`: nothing is known of the range yet,
// so that sparse probes may save frames.
Detections DetectRange(Clip& clip, const Background& background,
                       const TrackOptions& options, Detector detector,
                       const Range& range, std::int64_t step, bool first,
                       Range& seen) {
  Watcher watcher(clip, background, options, detector);
  LinkOptions link;
  link.most_missing *= static_cast<int>(step);
  ChainBuilder builder(link);
  Detections found;
  found.last = range.last;
  found.step = step;
  seen = {range.last, range.first};
  std::vector<bool> worth;  // empty: all are
  if (first) worth = WorthALook(clip, watcher, range, step, options);
  std::vector<std::int64_t> indices;
  for (std::int64_t index = range.first; index < range.last; index += step) {
    const auto look = static_cast<std::size_t>((index - range.first) / step);
    if (worth.empty() || worth[look]) indices.push_back(index);
  }
  std::vector<Seen> looks;
  if (CanReadApart(clip)) {
    looks.resize(indices.size());
    try {
      ReadApart(clip, looks.size(), options.threads,
                [&](Clip& reader, std::size_t i) {
                  looks[i] = watcher.Look(reader, indices[i]);
                });
    } catch (const core::InputError&) {
      // A reader met damage: one frame after the other, up to it.
      looks.clear();
    }
  }
  std::size_t more = 0;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const std::int64_t index = indices[i];
    try {
      const Seen look =
          looks.empty() ? watcher.Look(clip, index) : std::move(looks[i]);
      builder.Add(index, look.time_s, look.blobs);
      more += look.more ? 1 : 0;
      if (!look.blobs.empty()) {
        seen.first = std::min(seen.first, index);
        seen.last = index + 1;
      }
    } catch (const core::InputError&) {
      if (index == range.first) throw;
      std::string reason;
      found.last = FirstUnreadable(clip, index - step + 1, index + 1, reason);
      found.warning = fmt::format("frames from {} on cannot be read: {}",
                                  found.last, reason);
      break;
    }
    if (options.progress) {
      options.progress(static_cast<double>(index - options.first) /
                       static_cast<double>(range.last - options.first));
    }
  }
  clip.cancellation().Check();
  found.chains = builder.Finish();
  found.bounds = BoundsMet(more, indices.size(), builder.left_out());
  return found;
}

// Whether the sampled frames follow the body's path badly: it moves so far
// between two of them that interpolated starts are bad, or there are few
// detections.
bool TooCoarse(const Chain& chain) {
  // Detections of the tracklet. More samples cost time; with fewer the path is
  // known badly. Not studied.
  constexpr std::size_t kMinLinks = 48;
  // Of the size, in one step (90 % of the steps): farther, the next outline
  // starts outside the body. Not studied.
  constexpr double kMaxStepOfSize = 0.6;
  if (chain.links.size() < kMinLinks) return true;
  std::vector<double> moved;
  for (std::size_t i = 1; i < chain.links.size(); ++i) {
    const core::PixelPoint& a = chain.links[i - 1].blob.centre;
    const core::PixelPoint& b = chain.links[i].blob.centre;
    moved.push_back(std::hypot(b.x_px - a.x_px, b.y_px - a.y_px));
  }
  const auto high =
      moved.begin() + static_cast<std::ptrdiff_t>(moved.size() * 9 / 10);
  std::nth_element(moved.begin(), high, moved.end());
  return *high > kMaxStepOfSize * std::sqrt(chain.Area());
}

// Coarse to fine: halves the step until the best tracklet is followed closely
// enough, within the range in which anything was seen.
Detections Detect(Clip& clip, const Background& background,
                  const TrackOptions& options, Detector detector,
                  std::int64_t last) {
  // Frames: a longer step misses bodies that cross the picture in a few frames.
  // Not studied.
  constexpr std::int64_t kMaxStep = 8;
  const std::int64_t frames = last - options.first;
  std::int64_t step = 1;
  if (IsLong(clip, options)) {
    step = std::clamp<std::int64_t>(frames / options.first_looks, 1, kMaxStep);
  }
  Range range{options.first, last};
  Range seen;
  Detections found =
      DetectRange(clip, background, options, detector, range, step, true, seen);
  while (step > 1 &&
         (found.chains.empty() || TooCoarse(found.chains.front()))) {
    if (seen.last > seen.first) {
      range = {std::max(range.first, seen.first - step),
               std::min(range.last, seen.last + step)};
    }
    step /= 2;
    Detections closer = DetectRange(clip, background, options, detector, range,
                                    step, false, seen);
    closer.last = std::min(
        found.last, closer.last == range.last ? found.last : closer.last);
    if (closer.warning.empty()) closer.warning = found.warning;
    found = std::move(closer);
  }
  return found;
}

// Cost of an outline: residual over noise, raised where many pixels had to be
// left out (inliers squared).
double Badness(const std::optional<Fitted>& fitted) {
  // Cost of no outline: above that of any outline that was fitted. Not studied.
  constexpr double kNoFitCost = 50.0;
  if (!fitted) return kNoFitCost;
  const OutlineFit& fit = fitted->fit;
  return fit.misfit / std::max(0.05, fit.inliers * fit.inliers);
}

// Cost of a hypothesis: that of its outlines, over the square root of the
// frames that saw the body.
double LookCost(const Look& look) {
  if (look.found.chains.empty()) {
    return std::numeric_limits<double>::infinity();
  }
  return look.choice.badness /
         std::sqrt(static_cast<double>(look.found.chains.front().links.size()));
}

// Share of the other hypothesis's outlines with which one may win: a smoother
// one needs nearly as many, one that falls half of them. Set with the four
// recordings measured by hand, and with table_tennis_door.
constexpr double kAsManyFrames = 0.9;
constexpr double kFewFrames = 0.5;

// Whether a track is the body's because it is much smoother: outlines fitted to
// a ghost's edge jump about, however well they fit.
bool MuchSmoother(const Look& look, const Look& other) {
  // Ratio of the position noises. Larger lets noise decide between two good
  // tracks. Set with the four recordings measured by hand.
  constexpr double kNoiseRatio = 0.25;
  return Roughness(look.fits) < kNoiseRatio * Roughness(other.fits) &&
         static_cast<double>(look.fits.size()) >=
             kAsManyFrames * static_cast<double>(other.fits.size());
}

// A hypothesis that falls goes before one that fits: a person in the picture
// may fit better.
bool Falls(const Look& look) {
  return !look.found.chains.empty() && look.found.chains.front().Falls();
}

// The fewest outlines with which a hypothesis of known cost can still win
// (IsBetter); it need not be fitted further if a sample finds fewer.
double CountFitsToWin(const Look& look, const Look& rival) {
  if (LookCost(look) < LookCost(rival)) return 0.0;
  const bool falls = Falls(look) && !Falls(rival);
  return (falls ? kFewFrames : kAsManyFrames) *
         static_cast<double>(rival.fits.size());
}

// Outlines of the best tracklet; none where, by a sample of its detections,
// fewer than `least` will be found. A wrong hypothesis is the dearest, because
// none of its outlines converges.
std::vector<Fitted> FitLinks(Clip& clip, const Look& look,
                             const TrackOptions& options, double least) {
  // Every eighth detection is sampled. Not studied.
  constexpr std::size_t kSampled = 8;
  // Share of `least` that the sample must find: it may find half as many by
  // chance, or where outlines come in stretches. Not studied.
  constexpr double kSampleShare = 0.5;
  const Chain& chain = look.found.chains.front();
  const auto fit = [&](const LinkRange& range) {
    return FitChain(clip, look.background, chain, look.choice, options,
                    look.surround, range);
  };
  if (least <= 0.0) return fit({});
  if (static_cast<double>(chain.links.size()) < least) return {};
  if (static_cast<double>(fit({0, kSampled}).size() * kSampled) <
      kSampleShare * least) {
    return {};
  }
  return fit({});
}

}  // namespace

// An eighth of the clip: short enough that the picture may be empty there.
std::int64_t EndPart(std::int64_t first, std::int64_t last) {
  return std::max<std::int64_t>(3, (last - first) / 8);
}

// Fits both kinds in a few frames and takes the one that leaves the smaller
// residuals. Frames are chosen symmetrically, so that a clip played backwards
// gives the same.
Choice ChooseKind(Clip& clip, const Background& background, const Chain& chain,
                  const TrackOptions& options, Surround surround) {
  // Frames: more cost time, fewer let one bad frame decide. Not studied.
  constexpr std::size_t kKindProbes = 9;
  std::vector<const Link*> inside;
  for (const Link& link : chain.links) {
    if (!link.blob.at_border) inside.push_back(&link);
  }
  if (inside.empty()) {
    for (const Link& link : chain.links) inside.push_back(&link);
  }
  std::vector<const Link*> probes;
  const std::size_t n = std::min(kKindProbes, inside.size());
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t from_end = std::min(k, n - 1 - k);
    const std::size_t at = (2 * from_end + 1) * inside.size() / (2 * n);
    probes.push_back(from_end == k ? inside[at]
                                   : inside[inside.size() - 1 - at]);
  }
  std::vector<core::BodyKind> kinds = {core::BodyKind::kSphere,
                                       core::BodyKind::kRectangle};
  if (options.kind) kinds = {*options.kind};
  Choice best;
  for (const core::BodyKind kind : kinds) {
    std::vector<double> badness;
    std::vector<double> blur;
    std::vector<OutlineJob> jobs;
    jobs.reserve(probes.size());
    for (const Link* link : probes) {
      jobs.push_back({link->frame, MakeStart(link->blob, kind)});
    }
    OutlineOptions fit_options;
    fit_options.surround = surround;
    fit_options.ground = options.ground;
    for (const auto& fit :
         FitOutlines(clip, background, jobs, fit_options, options.threads)) {
      badness.push_back(Badness(fit));
      if (fit) blur.push_back(fit->fit.blur_px);
    }
    // The mean of the better half decides: a frame in contact, or one that is
    // half hidden, must not.
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

std::vector<Fitted> FitChain(Clip& clip, const Background& background,
                             const Chain& chain, const Choice& choice,
                             const TrackOptions& options, Surround surround,
                             const LinkRange& range) {
  OutlineOptions fit_options;
  fit_options.surround = surround;
  fit_options.ground = options.ground;
  fit_options.blur_px = choice.blur_px;
  std::vector<OutlineJob> jobs;
  for (std::size_t i = range.first; i < chain.links.size(); i += range.step) {
    const Link& link = chain.links[i];
    jobs.push_back({link.frame, MakeStart(link.blob, choice.kind)});
  }
  return Found(
      FitOutlines(clip, background, jobs, fit_options, options.threads));
}

// More samples for short clips, whose frames are all decoded anyway.
BackgroundOptions ChooseBackgroundOptions(const Clip& clip,
                                          const TrackOptions& options) {
  // Frames: noise of the background falls as 1/sqrt. Not studied.
  constexpr int kShortClipSamples = 64;
  BackgroundOptions background;
  if (options.background_samples > 0) {
    background.samples = options.background_samples;
  } else if (!IsLong(clip, options) && !clip.info().has_colour) {
    background.samples = kShortClipSamples;
  }
  background.among = options.still_frames;
  background.threads = options.threads;
  return background;
}

namespace {

// What a detector finds before a background: tracklets, and no outlines yet.
Look LookWith(Clip& clip, Background background, const TrackOptions& options,
              Detector detector, std::int64_t last) {
  Look look;
  look.background = std::move(background);
  look.surround = detector == Detector::kLevels ? Surround::kPolynomial
                                                : Surround::kBackground;
  look.found = Detect(clip, look.background, options, detector, last);
  look.rough_starts = detector == Detector::kChange;
  return look;
}

}  // namespace

// One hypothesis: a background and a detector give tracklets; the best one
// gives a kind and outlines. `rival`: the best so far; a hypothesis that cannot
// win is not fitted to the end.
Look TryHypothesis(Clip& clip, Background background,
                   const TrackOptions& options, Detector detector,
                   std::int64_t last, const Look* rival, double least_fits) {
  Look look = LookWith(clip, std::move(background), options, detector, last);
  if (look.found.chains.empty() ||
      static_cast<double>(look.found.chains.front().links.size()) <
          least_fits) {
    return look;
  }
  look.choice = ChooseKind(clip, look.background, look.found.chains.front(),
                           options, look.surround);
  if (rival != nullptr) {
    // Rough starts win by their cost alone.
    if (look.rough_starts && LookCost(look) > LookCost(*rival)) return look;
    least_fits = std::max(least_fits, CountFitsToWin(look, *rival));
  }
  look.fits = FitLinks(clip, look, options, least_fits);
  DropStrangers(look.fits);
  return look;
}

namespace {

// Whether one hypothesis follows something within the body of the other: a
// wheel's hole, a patch. It may fit better and is not the body.
bool IsWithin(const Look& look, const Look& other) {
  // Ratio of the sizes, distance of the centres as a share of the outer size,
  // and share of the frames seen by both. Not studied.
  constexpr double kMaxInnerRatio = 0.8;
  constexpr double kMaxOffCentre = 0.05;
  constexpr double kMinFrameShare = 0.8;
  std::size_t both = 0;
  std::size_t within = 0;
  for (const Fitted& f : look.fits) {
    const auto same =
        std::find_if(other.fits.begin(), other.fits.end(),
                     [&](const Fitted& o) { return o.frame == f.frame; });
    if (same == other.fits.end()) continue;
    ++both;
    const core::PixelPoint& a = f.fit.outline.centre;
    const core::PixelPoint& b = same->fit.outline.centre;
    const double size = OutlineSize(same->fit);
    within +=
        OutlineSize(f.fit) < kMaxInnerRatio * size &&
        std::hypot(a.x_px - b.x_px, a.y_px - b.y_px) < kMaxOffCentre * size;
  }
  return within > 0 && static_cast<double>(within) >
                           kMinFrameShare * static_cast<double>(both);
}

}  // namespace

// The order of two hypotheses: one that falls, with half of the other's
// outlines; then a much smoother one; then the cheaper one.
bool IsBetter(const Look& look, const Look& other) {
  if (Falls(look) != Falls(other)) {
    const Look& falling = Falls(look) ? look : other;
    const Look& resting = Falls(look) ? other : look;
    if (static_cast<double>(falling.fits.size()) >=
        kFewFrames * static_cast<double>(resting.fits.size())) {
      return Falls(look);
    }
  }
  return MuchSmoother(look, other) ||
         (LookCost(look) < LookCost(other) && !MuchSmoother(other, look));
}

namespace {

// Cost (Badness) above which an outline is no good model of the body's picture,
// or the background holds its ghost: other hypotheses are tried then. Smaller
// costs time; larger keeps a ghost. Not studied.
constexpr double kMaxGoodCost = 4.0;

const char* KindName(core::BodyKind kind) {
  return kind == core::BodyKind::kSphere ? "a sphere" : "a rectangle";
}

// Why the body is of another kind than the one that was stated; empty: nothing
// speaks against that. Only an outline that fits well is a witness, and only
// where that of the stated kind leaves twice as much. 25 of 26 spheres that
// were called blocks left 0.9 to 2.0 as spheres, one 3.0; blocks before their
// own ghosts left 3.5 to 4.0 as spheres.
std::string ReasonAgainstKind(Clip& clip, const Look& look,
                              const TrackOptions& options) {
  // Ratio of the residuals in favour of the other kind. Smaller refuses blocks
  // before their own ghosts; larger accepts wrong kinds. Set with 26 spheres
  // that were called blocks.
  constexpr double kClearRatio = 2.0;
  if (!options.kind || look.found.chains.empty() ||
      look.choice.badness <= kMaxGoodCost) {
    return {};
  }
  TrackOptions otherwise = options;
  otherwise.kind = *options.kind == core::BodyKind::kSphere
                       ? core::BodyKind::kRectangle
                       : core::BodyKind::kSphere;
  const Choice other =
      ChooseKind(clip, look.background, look.found.chains.front(), otherwise,
                 look.surround);
  // Cost up to which the other kind is a witness: 25 of the 26 spheres left 2.0
  // and less, blocks before their ghosts 3.5 and more.
  constexpr double kMaxWitnessCost = 2.5;
  if (other.badness > kMaxWitnessCost ||
      kClearRatio * other.badness > look.choice.badness) {
    return {};
  }
  return fmt::format(
      "the body looks like {}, not like {} as was stated: in a few frames {} "
      "leaves residuals of {:.1f} times the noise, {} {:.1f}; state the kind "
      "that it is",
      KindName(other.kind), KindName(*options.kind), KindName(other.kind),
      other.badness, KindName(*options.kind), look.choice.badness);
}

}  // namespace

Look LookPlainly(Clip& clip, const TrackOptions& options, std::int64_t last) {
  Look look =
      LookWith(clip,
               EstimateBackground(clip, options.first, last,
                                  ChooseBackgroundOptions(clip, options)),
               options, Detector::kDifference, last);
  if (look.found.chains.empty()) return look;
  look.choice = ChooseKind(clip, look.background, look.found.chains.front(),
                           options, look.surround);
  return look;
}

// The best of five hypotheses. A body that stays long in one place leaves its
// ghost in the background of all frames, and outlines fit badly. Then the
// background of the beginning is tried, where the picture may be empty, and
// that of the end; then the frame's own two levels; and last everything that
// changes.
core::Expected<Look> FirstLook(Clip& clip, const TrackOptions& options,
                               Look plain) {
  Look best = std::move(plain);
  const BackgroundOptions still = ChooseBackgroundOptions(clip, options);
  // A body of another kind fits badly by every background: that is told before
  // any other is tried.
  if (auto reason = ReasonAgainstKind(clip, best, options); !reason.empty()) {
    return core::AbsentBecause(std::move(reason));
  }
  if (!best.found.chains.empty()) {
    best.fits = FitLinks(clip, best, options, 0.0);
    DropStrangers(best.fits);
  }
  const std::int64_t last = best.found.last;
  const std::int64_t part = EndPart(options.first, last);
  for (int attempt = 0; attempt < 4 && best.choice.badness > kMaxGoodCost;
       ++attempt) {
    // The detector of each attempt; the comment above names their backgrounds.
    constexpr Detector kDetectors[] = {Detector::kDifference,
                                       Detector::kDifference, Detector::kLevels,
                                       Detector::kChange};
    const Detector detector = kDetectors[attempt];
    // Ratio of frames. Everything that changes holds shadows, too: this
    // hypothesis must follow the body through so many more frames, and is not
    // tried where it cannot. Set with the recorded hoop at 45 deg (18 frames
    // for 1).
    constexpr double kMinFrameGain = 1.5;
    const double least = kMinFrameGain * static_cast<double>(best.fits.size());
    const bool change = detector == Detector::kChange;
    if (change && static_cast<double>(last - options.first) <
                      least * static_cast<double>(best.found.step)) {
      continue;
    }
    Background background = best.background;
    if (attempt == 0) {
      background = EstimateBackground(
          clip, options.first, std::min(options.first + part, last), still);
    } else if (attempt == 1) {
      background = EstimateBackground(
          clip, std::max(options.first, last - part), last, still);
    }
    Look look = TryHypothesis(clip, std::move(background), options, detector,
                              last, &best, change ? least : 0.0);
    look.found.warning = best.found.warning;
    if (change && static_cast<double>(look.fits.size()) < least) continue;
    if (!Moves(look.fits)) continue;
    if (IsBetter(look, best) && !IsWithin(look, best)) best = std::move(look);
  }
  if (best.found.chains.empty()) {
    return core::AbsentBecause("nothing moves in these frames");
  }
  if (auto reason = ReasonAgainstKind(clip, best, options); !reason.empty()) {
    return core::AbsentBecause(std::move(reason));
  }
  // Frames: fewer make no path.
  constexpr std::size_t kMinFrames = 3;
  if (best.fits.size() < kMinFrames) {
    std::string reason =
        "something moves, but no outline of a sphere or rectangle fits it";
    for (const std::string& bound : best.found.bounds) reason += "; " + bound;
    return core::AbsentBecause(std::move(reason));
  }
  return best;
}

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

}  // namespace touchdown::vision
