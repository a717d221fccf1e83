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

// Which of every `step`-th frame of the range are worth a look: those within
// four glimpses of one that saw anything. All, where none did.
std::vector<bool> WorthALook(Clip& clip, const Watcher& watcher,
                             const Range& range, std::int64_t step,
                             const TrackOptions& options) {
  const auto count =
      static_cast<std::size_t>((range.last - range.first + step - 1) / step);
  std::vector<bool> worth(count, true);
  if (!watcher.CanGlimpse(clip)) return worth;
  constexpr std::size_t kPhases = 4;
  constexpr std::int64_t kLargestStep = 32;  // frames
  const std::int64_t stride = std::clamp(
      (range.last - range.first) / options.first_looks, step, kLargestStep);
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

// Bounds that were met: in `more` of `looks` frames there was more to follow
// than is kept, and `left_out` chains were too many.
std::vector<std::string> BoundsMet(std::size_t more, std::size_t looks,
                                   std::size_t left_out) {
  // Fewer frames cost a chain a link here and there, as an occlusion does.
  constexpr double kTold = 0.1;
  std::vector<std::string> bounds;
  if (static_cast<double>(more) > kTold * static_cast<double>(looks)) {
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

// Every `step`-th frame of the range, and its last one. `seen` receives the
// range in which anything was seen. `first`: nothing is known of it yet.
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
      looks.clear();  // one by one: up to the damage
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

// True if so few looks follow the body's path: between two of them it moves so
// far that what lies between is no good start, or there are few of them.
bool TooCoarse(const Chain& chain) {
  constexpr std::size_t kEnough = 48;  // links
  constexpr double kMostMotion = 0.6;  // of the size, in one step
  if (chain.links.size() < kEnough) return true;
  std::vector<double> moved;
  for (std::size_t i = 1; i < chain.links.size(); ++i) {
    const core::PixelPoint& a = chain.links[i - 1].blob.centre;
    const core::PixelPoint& b = chain.links[i].blob.centre;
    moved.push_back(std::hypot(b.x_px - a.x_px, b.y_px - a.y_px));
  }
  const auto high =
      moved.begin() + static_cast<std::ptrdiff_t>(moved.size() * 9 / 10);
  std::nth_element(moved.begin(), high, moved.end());
  return *high > kMostMotion * std::sqrt(chain.Area());
}

Detections Detect(Clip& clip, const Background& background,
                  const TrackOptions& options, Detector detector,
                  std::int64_t last) {
  constexpr std::int64_t kLargestStep = 8;
  const std::int64_t frames = last - options.first;
  std::int64_t step = 1;
  if (IsLong(clip, options)) {
    step =
        std::clamp<std::int64_t>(frames / options.first_looks, 1, kLargestStep);
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

// How badly an outline explains the pixels: residuals over noise, dearer where
// many pixels had to be left out.
double Badness(const std::optional<Fitted>& fitted) {
  constexpr double kNoFit = 50.0;
  if (!fitted) return kNoFit;
  const OutlineFit& fit = fitted->fit;
  return fit.misfit / std::max(0.05, fit.inliers * fit.inliers);
}

// Badness of the outlines; dearer where the body was seen in few frames.
double LookCost(const Look& look) {
  if (look.found.chains.empty()) {
    return std::numeric_limits<double>::infinity();
  }
  return look.choice.badness /
         std::sqrt(static_cast<double>(look.found.chains.front().links.size()));
}

// Of two hypotheses a smoother one wins with so many of the other's outlines,
// one that falls with half of them.
constexpr double kAsManyFrames = 0.9;
constexpr double kFewFrames = 0.5;

// Outlines fitted to a ghost's edge jump about, however well they fit: a track
// of as many frames that is four times smoother is the body's.
bool MuchSmoother(const Look& look, const Look& other) {
  constexpr double kSmoother = 0.25;
  return Roughness(look.fits) < kSmoother * Roughness(other.fits) &&
         static_cast<double>(look.fits.size()) >=
             kAsManyFrames * static_cast<double>(other.fits.size());
}

// What falls before what fits: a person in the picture may fit better.
bool Falls(const Look& look) {
  return !look.found.chains.empty() && look.found.chains.front().Falls();
}

// Fewest outlines with which a hypothesis of known cost can win (IsBetter).
double CountFitsToWin(const Look& look, const Look& rival) {
  if (LookCost(look) < LookCost(rival)) return 0.0;
  const bool falls = Falls(look) && !Falls(rival);
  return (falls ? kFewFrames : kAsManyFrames) *
         static_cast<double>(rival.fits.size());
}

// The outlines of the best chain; none where fewer than `least` will be found,
// by a sample of the links.
std::vector<Fitted> FitLinks(Clip& clip, const Look& look,
                             const TrackOptions& options, double least) {
  constexpr std::size_t kSampled = 8;  // every eighth link
  // A sample finds half as many by chance, or where they come in stretches.
  constexpr double kUnlucky = 0.5;
  const Chain& chain = look.found.chains.front();
  const auto fit = [&](const LinkRange& range) {
    return FitChain(clip, look.background, chain, look.choice, options,
                    look.surround, range);
  };
  if (least <= 0.0) return fit({});
  if (static_cast<double>(chain.links.size()) < least) return {};
  if (static_cast<double>(fit({0, kSampled}).size() * kSampled) <
      kUnlucky * least) {
    return {};
  }
  return fit({});
}

}  // namespace

std::int64_t EndPart(std::int64_t first, std::int64_t last) {
  return std::max<std::int64_t>(3, (last - first) / 8);
}

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

BackgroundOptions ChooseBackgroundOptions(const Clip& clip,
                                          const TrackOptions& options) {
  constexpr int kOfShort = 64;  // frames
  BackgroundOptions background;
  if (options.background_samples > 0) {
    background.samples = options.background_samples;
  } else if (!IsLong(clip, options) && !clip.info().has_colour) {
    background.samples = kOfShort;
  }
  background.among = options.still_frames;
  background.threads = options.threads;
  return background;
}

Look TryHypothesis(Clip& clip, Background background,
                   const TrackOptions& options, Detector detector,
                   std::int64_t last, const Look* rival, double least_fits) {
  Look look;
  look.background = std::move(background);
  look.surround = detector == Detector::kLevels ? Surround::kPolynomial
                                                : Surround::kBackground;
  look.found = Detect(clip, look.background, options, detector, last);
  look.rough_starts = detector == Detector::kChange;
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

// Whether `look` follows something within the body that `other` follows: a
// wheel's hole, a patch. It may fit better, and is not the body.
bool IsWithin(const Look& look, const Look& other) {
  constexpr double kSmaller = 0.8;
  constexpr double kConcentric = 0.05;  // of the outer size
  constexpr double kMostly = 0.8;       // of the frames that both saw
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
    within += OutlineSize(f.fit) < kSmaller * size &&
              std::hypot(a.x_px - b.x_px, a.y_px - b.y_px) < kConcentric * size;
  }
  return within > 0 &&
         static_cast<double>(within) > kMostly * static_cast<double>(both);
}

}  // namespace

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

// Above this badness an outline is no good model of the body's picture, or the
// background holds its ghost.
constexpr double kWellFitted = 4.0;

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
  constexpr double kClearly = 2.0;
  if (!options.kind || look.found.chains.empty() ||
      look.choice.badness <= kWellFitted) {
    return {};
  }
  TrackOptions otherwise = options;
  otherwise.kind = *options.kind == core::BodyKind::kSphere
                       ? core::BodyKind::kRectangle
                       : core::BodyKind::kSphere;
  const Choice other =
      ChooseKind(clip, look.background, look.found.chains.front(), otherwise,
                 look.surround);
  constexpr double kWitness = 2.5;
  if (other.badness > kWitness ||
      kClearly * other.badness > look.choice.badness) {
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

// A body that stays long where it is leaves its ghost in the mean of all
// frames, and outlines fit badly. Then the picture may be empty at the
// beginning, or at the end; where it never is, the frame's own two levels must
// do.
core::Expected<Look> FirstLook(Clip& clip, const TrackOptions& options,
                               std::int64_t last) {
  const BackgroundOptions still = ChooseBackgroundOptions(clip, options);
  Look best =
      TryHypothesis(clip, EstimateBackground(clip, options.first, last, still),
                    options, Detector::kDifference, last);
  // A body of another kind fits badly by every background: that is told before
  // any other is tried.
  if (auto reason = ReasonAgainstKind(clip, best, options); !reason.empty()) {
    return core::AbsentBecause(std::move(reason));
  }
  const std::int64_t part = EndPart(options.first, last);
  for (int attempt = 0; attempt < 4 && best.choice.badness > kWellFitted;
       ++attempt) {
    constexpr Detector kDetectors[] = {Detector::kDifference,
                                       Detector::kDifference, Detector::kLevels,
                                       Detector::kChange};
    const Detector detector = kDetectors[attempt];
    // All that changes holds shadows, too: it must follow the body much farther
    // than what was found, and is not tried where it cannot.
    constexpr double kFarther = 1.5;
    const double least = kFarther * static_cast<double>(best.fits.size());
    const bool change = detector == Detector::kChange;
    if (change && static_cast<double>(best.found.last - options.first) <
                      least * static_cast<double>(best.found.step)) {
      continue;
    }
    Background background = best.background;
    if (attempt == 0) {
      background = EstimateBackground(
          clip, options.first, std::min(options.first + part, last), still);
    } else if (attempt == 1) {
      background = EstimateBackground(
          clip, std::max(options.first, best.found.last - part),
          best.found.last, still);
    }
    Look look = TryHypothesis(clip, std::move(background), options, detector,
                              best.found.last, &best, change ? least : 0.0);
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
  constexpr std::size_t kLeastFrames = 3;
  if (best.fits.size() < kLeastFrames) {
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
