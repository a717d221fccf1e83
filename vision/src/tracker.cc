#include "touchdown/vision/tracker.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "chain.h"
#include "detect.h"
#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

double Median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle =
      values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

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
                  const TrackOptions& options,
                  OutlineOptions::Surround surround) {
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

struct Fitted {
  std::int64_t frame = 0;
  double time_s = 0.0;
  OutlineFit fit;
};

double SizeOf(const OutlineFit& fit) {
  return fit.outline.kind == core::BodyKind::kSphere ? fit.outline.radius_px
                                                     : fit.outline.half_long_px;
}

std::vector<Fitted> FitAll(Clip& clip, const Background& background,
                           const Chain& chain, const Choice& choice,
                           const TrackOptions& options,
                           OutlineOptions::Surround surround) {
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

// Fits that are not of this body: other size, or far worse residuals than
// usual.
void DropStrangers(std::vector<Fitted>& all) {
  std::vector<double> sizes;
  std::vector<double> misfits;
  for (const Fitted& f : all) {
    sizes.push_back(SizeOf(f.fit));
    misfits.push_back(f.fit.misfit);
  }
  const double size = Median(sizes);
  const double misfit = Median(misfits);
  constexpr double kSizeRatio = 1.35;
  constexpr double kMisfitRatio = 4.0;
  std::erase_if(all, [&](const Fitted& f) {
    return SizeOf(f.fit) > kSizeRatio * size ||
           SizeOf(f.fit) * kSizeRatio < size ||
           f.fit.misfit > kMisfitRatio * std::max(1.0, misfit);
  });
}

// Mean weighted by inverse variance, robustly: values off the median by more
// than four times the scatter are left out. u from the scatter, or from the
// fits' uncertainties where that is larger.
core::Estimate RobustMean(const std::vector<double>& values,
                          const std::vector<double>& us) {
  const double centre = Median(values);
  std::vector<double> off;
  for (const double v : values) off.push_back(std::abs(v - centre));
  const double scatter = 1.4826 * Median(off);
  double sw = 0.0;
  double swx = 0.0;
  double n = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::abs(values[i] - centre) > 4.0 * scatter + 1e-12) continue;
    const double w = 1.0 / (us[i] * us[i] + 1e-12);
    sw += w;
    swx += w * values[i];
    n += 1.0;
  }
  if (n < 1.0) return {centre, scatter};
  return {swx / sw, std::max(1.0 / std::sqrt(sw), scatter / std::sqrt(n))};
}

BodyImage Shape(const std::vector<Fitted>& all, core::BodyKind kind) {
  std::vector<double> size, size_u, shorter, shorter_u, blur, contrast;
  // Only outlines that are wholly seen tell the size.
  for (const bool strict : {true, false}) {
    for (const Fitted& f : all) {
      if (strict && f.fit.visible < 0.98) continue;
      size.push_back(SizeOf(f.fit));
      size_u.push_back(f.fit.u_size_px);
      shorter.push_back(f.fit.outline.half_short_px);
      shorter_u.push_back(f.fit.u_size_short_px);
      blur.push_back(f.fit.blur_px);
      contrast.push_back(f.fit.contrast_dn);
    }
    if (size.size() >= 3) break;
  }
  BodyImage body;
  body.kind = kind;
  body.blur_px = Median(blur);
  body.contrast_dn = Median(contrast);
  if (kind == core::BodyKind::kSphere) {
    body.radius_px = RobustMean(size, size_u);
  } else {
    body.half_long_px = RobustMean(size, size_u);
    body.half_short_px = RobustMean(shorter, shorter_u);
    if (body.half_long_px.value < body.half_short_px.value) {
      std::swap(body.half_long_px, body.half_short_px);
    }
  }
  return body;
}

// A body that comes nearer grows: a straight line through the sizes, used only
// where the change is large against its uncertainty and matters.
void FollowSize(const std::vector<Fitted>& all, Track& track) {
  if (track.body.kind != core::BodyKind::kSphere || all.size() < 12) return;
  double sw = 0, st = 0, sr = 0, stt = 0, str = 0;
  for (const Fitted& f : all) {
    if (f.fit.visible < 0.98) continue;
    const double w = 1.0 / (f.fit.u_size_px * f.fit.u_size_px + 1e-6);
    sw += w;
    st += w * f.time_s;
    sr += w * f.fit.outline.radius_px;
    stt += w * f.time_s * f.time_s;
    str += w * f.time_s * f.fit.outline.radius_px;
  }
  const double determinant = sw * stt - st * st;
  if (!(determinant > 0.0)) return;
  const double slope = (sw * str - st * sr) / determinant;
  const double level = (sr - slope * st) / sw;
  const double span = all.back().time_s - all.front().time_s;
  const double change = slope * span / track.body.radius_px.value;
  double square = 0.0;
  for (const Fitted& f : all) {
    const double r = f.fit.outline.radius_px - level - slope * f.time_s;
    square += r * r;
  }
  const double scatter = std::sqrt(square / static_cast<double>(all.size()));
  constexpr double kMatters = 0.01;
  const double noise = scatter / track.body.radius_px.value /
                       std::sqrt(static_cast<double>(all.size()) / 12.0);
  if (std::abs(change) < kMatters || std::abs(change) < 5.0 * noise) return;
  for (Pose& pose : track.poses) {
    pose.relative_size =
        (level + slope * pose.time_s) / track.body.radius_px.value;
  }
  track.warnings.push_back(
      fmt::format("the body's image changes size by {:.1f} % over the clip: it "
                  "moves towards "
                  "or away from the camera, and the scale with it",
                  100.0 * change));
}

double Period(const BodyImage& body) {
  constexpr double kSquare = 1.05;  // sides nearer than 5 %: a quarter turn
  return body.half_long_px.value < kSquare * body.half_short_px.value
             ? 0.5 * std::numbers::pi
             : std::numbers::pi;
}

Pose PoseOf(const Fitted& f) {
  Pose pose;
  pose.frame = f.frame;
  pose.time_s = f.time_s;
  pose.centre = f.fit.outline.centre;
  pose.angle_rad = f.fit.outline.angle_rad;
  pose.u_x_px = f.fit.u_x_px;
  pose.u_y_px = f.fit.u_y_px;
  pose.correlation_xy = f.fit.correlation_xy;
  pose.u_angle_rad = f.fit.u_angle_rad;
  pose.misfit = f.fit.misfit;
  return pose;
}

// Directions of a side are known up to a half turn: make them continuous.
void Unwrap(Track& track) {
  if (track.body.kind != core::BodyKind::kRectangle || track.poses.empty()) {
    return;
  }
  const double period = Period(track.body);
  double last = std::remainder(track.poses.front().angle_rad, period);
  for (Pose& pose : track.poses) {
    pose.angle_rad = last + std::remainder(pose.angle_rad - last, period);
    last = pose.angle_rad;
  }
}

Outline OutlineAt(const BodyImage& body, const Pose& pose) {
  Outline outline;
  outline.kind = body.kind;
  outline.centre = pose.centre;
  outline.angle_rad = pose.angle_rad;
  outline.radius_px = body.radius_px.value * pose.relative_size;
  outline.half_long_px = body.half_long_px.value * pose.relative_size;
  outline.half_short_px = body.half_short_px.value * pose.relative_size;
  return outline;
}

}  // namespace

core::Expected<TrackResult> TrackBody(Clip& clip, const Background& background,
                                      const TrackOptions& options) {
  const std::int64_t last = options.last < 0
                                ? clip.info().frames
                                : std::min(options.last, clip.info().frames);
  using Surround = OutlineOptions::Surround;
  using Clock = std::chrono::steady_clock;

  Found found = Detect(clip, background, options, Detector::kDifference, last);
  Choice choice;
  Surround surround = Surround::kBackground;
  if (!found.chains.empty()) {
    choice =
        ChooseKind(clip, background, found.chains.front(), options, surround);
  }
  // Where the body never leaves some of its pixels, the background holds its
  // ghost and the outlines fit badly: look at the frame's own two levels.
  constexpr double kWellFitted = 4.0;
  if (choice.badness > kWellFitted) {
    Found by_level = Detect(clip, background, options, Detector::kLevels, last);
    if (!by_level.chains.empty()) {
      const Choice other = ChooseKind(clip, background, by_level.chains.front(),
                                      options, Surround::kPolynomial);
      if (other.badness < choice.badness) {
        found = std::move(by_level);
        choice = other;
        surround = Surround::kPolynomial;
      }
    }
  }
  if (found.chains.empty()) {
    return core::AbsentBecause("nothing moves in these frames");
  }

  const auto before = Clock::now();
  const Chain& chain = found.chains.front();
  std::vector<Fitted> all =
      FitAll(clip, background, chain, choice, options, surround);
  DropStrangers(all);
  constexpr std::size_t kLeastFrames = 3;
  if (all.size() < kLeastFrames) {
    return core::AbsentBecause(
        "something moves, but no outline of a sphere or rectangle fits it");
  }
  TrackResult result;
  Track& track = result.track;
  track.first_frame = options.first;
  track.last_frame = found.last;
  track.frame_interval_s = 1.0 / clip.info().time_base.fps;
  if (!found.warning.empty()) track.warnings.push_back(found.warning);
  track.body = Shape(all, choice.kind);
  for (const Fitted& f : all) track.poses.push_back(PoseOf(f));
  Unwrap(track);
  FollowSize(all, track);
  for (std::size_t i = 1; i < found.chains.size(); ++i) {
    track.several_bodies |= IsAnotherBody(chain, found.chains[i]);
  }
  track.known_background = surround == Surround::kBackground;
  result.frames_read = found.last - options.first;
  result.fit_s = std::chrono::duration<double>(Clock::now() - before).count();
  return result;
}

Track Refine(Clip& clip, const Background& background, const Track& track,
             const calib::GroundLine& ground) {
  Track refined = track;
  refined.poses.clear();
  OutlineOptions options;
  options.surround = track.known_background
                         ? OutlineOptions::Surround::kBackground
                         : OutlineOptions::Surround::kPolynomial;
  options.fit_size = false;
  options.fit_blur = false;
  options.blur_px = track.body.blur_px;
  options.ground = ground;
  for (const Pose& pose : track.poses) {
    const core::Frame frame = clip.Read(pose.frame);
    const auto fit =
        FitOutline(frame, background, OutlineAt(track.body, pose), options);
    if (!fit) continue;
    Fitted f{pose.frame, pose.time_s, *fit};
    Pose better = PoseOf(f);
    better.relative_size = pose.relative_size;
    refined.poses.push_back(better);
  }
  Unwrap(refined);
  return refined;
}

}  // namespace touchdown::vision
