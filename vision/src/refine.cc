#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "between_looks.h"
#include "body_cover.h"
#include "outline_batch.h"
#include "touchdown/vision/tracker.h"
#include "track_shape.h"

namespace touchdown::vision {
namespace {

using NearGround = OutlineOptions::NearGround;
using Surround = OutlineOptions::Surround;

// a and b of one thing, each with its uncertainty, as one.
core::Estimate Combined(const core::Estimate& a, const core::Estimate& b) {
  const double wa = 1.0 / std::max(a.u * a.u, 1e-18);
  const double wb = 1.0 / std::max(b.u * b.u, 1e-18);
  return {(a.value * wa + b.value * wb) / (wa + wb), 1.0 / std::sqrt(wa + wb),
          std::nullopt};
}

// Of a body in one frame interval.
struct Motion {
  double x_px = 0.0;
  double y_px = 0.0;
  double turn_rad = 0.0;
};

Motion Between(const Pose& a, const Pose& b) {
  const double frames = static_cast<double>(b.frame - a.frame);
  return {(b.centre.x_px - a.centre.x_px) / frames,
          (b.centre.y_px - a.centre.y_px) / frames,
          (b.angle_rad - a.angle_rad) / frames};
}

double Apart(const Motion& a, const Motion& b) {
  return std::hypot(a.x_px - b.x_px, a.y_px - b.y_px);
}

// The motion at pose i, from the side on which it is the steadier: a blow
// changes it from one frame to the next.
Motion MotionAt(const std::vector<Pose>& poses, std::size_t i) {
  const std::size_t n = poses.size();
  if (n < 2) return {};
  if (i == 0) return Between(poses[0], poses[1]);
  if (i + 1 == n) return Between(poses[n - 2], poses[n - 1]);
  const Motion back = Between(poses[i - 1], poses[i]);
  const Motion on = Between(poses[i], poses[i + 1]);
  const double change_back =
      i >= 2 ? Apart(Between(poses[i - 2], poses[i - 1]), back) : 0.0;
  const double change_on =
      i + 2 < n ? Apart(on, Between(poses[i + 1], poses[i + 2])) : 0.0;
  // Alike on both sides: the mean is the less noisy.
  if (Apart(back, on) < 2.0 * std::max({change_back, change_on, 0.1})) {
    return {0.5 * (back.x_px + on.x_px), 0.5 * (back.y_px + on.y_px),
            0.5 * (back.turn_rad + on.turn_rad)};
  }
  return change_back <= change_on ? back : on;
}

// One coefficient over the frames: its median, and how far a frame's own may
// lie from it beyond the fits' noise.
void PriorOf(const std::vector<double>& values, const std::vector<double>& us,
             double& level, double& u) {
  level = Median(values);
  std::vector<double> off;
  off.reserve(values.size());
  for (const double v : values) off.push_back(std::abs(v - level));
  const double scatter = 1.4826 * Median(off);
  const double noise = Median(us);
  const double own = std::max(0.0, scatter * scatter - noise * noise);
  // The median's own uncertainty, pi/2 times the mean's variance.
  const double n = static_cast<double>(values.size());
  u = std::sqrt(own + 1.5708 * noise * noise / n);
}

// The body's shading as the frames that show it whole agree on.
std::optional<Shading> ShadingOf(const std::vector<Fitted>& all) {
  constexpr double kWhole = 0.98;
  constexpr std::size_t kLeast = 8;
  std::vector<const OutlineFit*> whole;
  for (const Fitted& f : all) {
    if (f.fit.visible >= kWhole && f.fit.shading) whole.push_back(&f.fit);
  }
  if (whole.size() < kLeast) return std::nullopt;
  Shading shading;
  for (std::size_t k = 0; k < shading.level.size(); ++k) {
    std::vector<double> values;
    std::vector<double> us;
    for (const OutlineFit* fit : whole) {
      values.push_back(fit->shading->level[k]);
      us.push_back(fit->shading->u[k]);
    }
    PriorOf(values, us, shading.level[k], shading.u[k]);
    if (!(shading.u[k] > 0.0)) return std::nullopt;
  }
  return shading;
}

// What all frames share of the camera.
std::optional<double> Shared(const std::vector<Fitted>& all,
                             double OutlineFit::*value, double OutlineFit::*u) {
  std::vector<double> values;
  std::vector<double> us;
  for (const Fitted& f : all) {
    if (!(f.fit.*u > 0.0)) continue;
    values.push_back(f.fit.*value);
    us.push_back(f.fit.*u);
  }
  if (values.empty()) return std::nullopt;
  return RobustMean(values, us).value;
}

// A body that is no sphere or rectangle, or lies behind others, may lose its
// size in a free fit: what was found is kept then.
bool IsSameSize(const BodyImage& again, const BodyImage& found) {
  constexpr double kMost = 0.2;    // change
  constexpr double kMostU = 0.05;  // both relative to the size
  const auto same = [&](const core::Estimate& a, const core::Estimate& b) {
    return std::abs(a.value - b.value) <= kMost * b.value &&
           a.u <= kMostU * b.value;
  };
  if (found.kind == core::BodyKind::kSphere) {
    return same(again.radius_px, found.radius_px);
  }
  return same(again.half_long_px, found.half_long_px) &&
         same(again.half_short_px, found.half_short_px);
}

class Refiner {
 public:
  Refiner(Clip& clip, const Background& background, const Track& track,
          const RefineOptions& refine)
      : clip_(clip),
        background_(background),
        track_(track),
        threads_(refine.threads) {
    options_.surround =
        track.known_background ? Surround::kBackground : Surround::kPolynomial;
    options_.blur_px = track.body.blur_px;
    options_.ground = refine.ground;
    // The blurred edges of body and ground do not superpose: clear of both, as
    // long as half of the body is left.
    constexpr double kBlurs = 2.5;
    constexpr double kMostOfHalf = 1.0;
    const double half = track.body.kind == core::BodyKind::kSphere
                            ? track.body.radius_px.value
                            : track.body.half_short_px.value;
    options_.ground_margin_px =
        std::max(options_.ground_margin_px,
                 std::min(kBlurs * track.body.blur_px, kMostOfHalf * half));
    for (std::size_t i = 0; i < track.poses.size(); ++i) {
      motion_.push_back(MotionAt(track.poses, i));
    }
  }

  // Whether the picture near the ground line is what the body alone makes of
  // it, so that the lower edge need not be left out.
  void LookNearGround(Track& refined);
  // The size once more, now that the ground is left out: a body that lies on it
  // had the ground's edge taken for its own. With it blur, exposure, shading.
  void LearnShape(Track& refined);
  void MeasurePoses(Track& refined);
  // The body as some frames show it.
  std::vector<Fitted> Sample(const BodyImage& body);

 private:
  OutlineJob JobAt(const BodyImage& body, std::size_t i) const {
    const Pose& pose = track_.poses[i];
    const Motion& motion = motion_[i];
    return {pose.frame, OutlineAt(body, pose),
            core::PixelPoint{motion.x_px, motion.y_px}, motion.turn_rad};
  }
  // Takes the fits of a body that is hidden in part out, and its frames from
  // the poses to come.
  void LeaveOutHidden(std::vector<Fitted>& sized);
  bool IsHidden(std::int64_t frame) const {
    return std::any_of(hidden_.begin(), hidden_.end(), [&](const Frames& f) {
      return f.first <= frame && frame <= f.last;
    });
  }
  // Of every `step`-th pose.
  std::vector<std::optional<Fitted>> FitPoses(const BodyImage& body,
                                              std::size_t step) {
    std::vector<OutlineJob> jobs;
    for (std::size_t i = 0; i < track_.poses.size(); i += step) {
      jobs.push_back(JobAt(body, i));
    }
    return FitOutlines(clip_, background_, jobs, options_, threads_);
  }

  Clip& clip_;
  const Background& background_;
  const Track& track_;
  int threads_;
  struct Frames {
    std::int64_t first = 0;  // both included
    std::int64_t last = 0;
  };
  std::vector<Frames> hidden_;  // in which something hides the body in part
  OutlineOptions options_;
  std::vector<Motion> motion_;  // at each pose
};

void Refiner::LookNearGround(Track& refined) {
  refined.near_ground_modelled = false;
  // What a body on a wavy edge hides is no level line.
  constexpr double kEven_px = 0.1;
  if (!track_.known_background || options_.ground->wave_px > kEven_px) return;
  // Of the poses that reach down there, evenly.
  constexpr std::size_t kEnough = 40;  // some thousand pixels in all
  std::vector<std::size_t> low;
  for (std::size_t i = 0; i < track_.poses.size(); ++i) {
    const Pose& pose = track_.poses[i];
    const Outline outline = OutlineAt(track_.body, pose);
    const double gap =
        calib::HeightAbove(*options_.ground, pose.centre) -
        SupportHeight(outline, calib::ImageAngle(*options_.ground));
    if (gap < options_.ground_margin_px) low.push_back(i);
  }
  const std::size_t step = (low.size() + kEnough - 1) / kEnough;
  std::vector<OutlineJob> jobs;
  for (std::size_t i = 0; i < low.size(); i += step) {
    jobs.push_back(JobAt(track_.body, low[i]));
  }
  options_.near_ground = NearGround::kModelled;
  double pixels = 0.0;
  double excess = 0.0;
  std::vector<double> misfits;
  for (const auto& fit :
       FitOutlines(clip_, background_, jobs, options_, threads_)) {
    if (!fit) continue;
    pixels += fit->fit.pixels_near_ground;
    excess += fit->fit.pixels_near_ground * fit->fit.excess_near_ground;
    misfits.push_back(fit->fit.misfit);
  }
  // A mean square of n residuals scatters by sqrt(2/n); in 1000 clips of even
  // ground it lay between 0.87 and 1.2, of those with a shadow at 2 and more.
  constexpr double kMostExcess = 1.25;
  constexpr double kSigmas = 4.0;
  // A body that is crudely modelled says nothing of what is near it.
  if (excess > kMostExcess * pixels + kSigmas * std::sqrt(2.0 * pixels) ||
      misfits.empty() || Median(misfits) > kWellModelled) {
    options_.near_ground = NearGround::kLeftOut;
    return;
  }
  refined.near_ground_modelled = true;
}

std::vector<Fitted> Refiner::Sample(const BodyImage& body) {
  constexpr std::size_t kEnough = 80;  // frames; u falls as 1/sqrt
  const std::size_t step =
      std::max<std::size_t>(1, track_.poses.size() / kEnough);
  std::vector<Fitted> all = Found(FitPoses(body, step));
  DropStrangers(all);
  return all;
}

void Refiner::LearnShape(Track& refined) {
  constexpr std::size_t kLeast = 3;
  // The exposure, where the body moves by enough of its blur to show it.
  std::vector<double> ways;
  for (const Motion& motion : motion_) {
    ways.push_back(std::hypot(motion.x_px, motion.y_px));
  }
  options_.fit_blur = true;
  options_.fit_open = Median(ways) > track_.body.blur_px;
  constexpr double kStart = 0.3;  // of the frame interval
  if (options_.fit_open) options_.open = kStart;
  std::vector<Fitted> sized = Sample(refined.body);
  const double open = std::clamp(
      Shared(sized, &OutlineFit::open, &OutlineFit::u_open).value_or(0.0), 0.0,
      1.0);
  options_.open = 0.0;
  if (sized.size() >= kLeast &&
      IsSameSize(ShapeOf(sized, track_.body.kind), track_.body)) {
    if (options_.fit_open) options_.open = open;
    refined.body.blur_px =
        Shared(sized, &OutlineFit::blur_px, &OutlineFit::u_blur_px)
            .value_or(refined.body.blur_px);
  }
  options_.fit_open = false;
  options_.fit_blur = false;
  options_.blur_px = refined.body.blur_px;
  sized = Sample(refined.body);
  if (sized.size() < kLeast) return;
  LeaveOutHidden(sized);
  if (sized.size() < kLeast) return;
  // Not with the shading held: its error is common to all frames, and what it
  // does to the size would not show in their scatter.
  options_.shading = ShadingOf(sized);
  const BodyImage shape = ShapeOf(sized, track_.body.kind);
  if (!IsSameSize(shape, track_.body)) return;
  refined.body.radius_px = shape.radius_px;
  refined.body.half_long_px = shape.half_long_px;
  refined.body.half_short_px = shape.half_short_px;
}

void Refiner::LeaveOutHidden(std::vector<Fitted>& sized) {
  const std::vector<bool> hidden = FindHidden(sized);
  std::vector<Fitted> whole;
  for (std::size_t i = 0; i < sized.size(); ++i) {
    if (!hidden[i]) {
      whole.push_back(sized[i]);
      continue;
    }
    // And the frames from the last one that was looked at to the next.
    const std::int64_t first = i > 0 ? sized[i - 1].frame + 1 : 0;
    const std::int64_t last = i + 1 < sized.size() ? sized[i + 1].frame - 1
                                                   : track_.poses.back().frame;
    hidden_.push_back({first, last});
  }
  sized = std::move(whole);
}

void Refiner::MeasurePoses(Track& refined) {
  options_.fit_size = false;
  options_.fit_blur = false;
  options_.starts_near = true;
  refined.poses.clear();
  std::vector<Fitted> fits = Found(FitPoses(refined.body, 1));
  // Between two looks none has been asked yet whether it is of the body.
  if (track_.step > 1) DropStrangers(fits);
  refined.step = 1;
  for (const Fitted& fit : fits) {
    if (IsHidden(fit.frame)) continue;
    Pose better = PoseOf(fit);
    better.relative_size = PoseIn(track_, fit.frame)->relative_size;
    refined.poses.push_back(better);
  }
}

}  // namespace

Track Refine(Clip& clip, const Background& background, const Track& given,
             const RefineOptions& refine) {
  const Track track = Bridged(given);
  Track refined = track;
  Refiner refiner(clip, background, track, refine);
  refiner.LookNearGround(refined);
  if (IsSteady(track)) {
    refiner.LearnShape(refined);
  } else {
    // A body that comes to the ground seems to change where the ground's edge
    // was taken for its own.
    Track again = track;
    KeepSize(again);
    FollowSize(refiner.Sample(track.body), again);
    if (IsSteady(again)) return Refine(clip, background, again, refine);
  }
  if (refine.aspect && track.body.kind == core::BodyKind::kRectangle &&
      track.body.whole_px == 0.0) {
    const core::Estimate& a = refined.body.half_long_px;
    const core::Estimate& ratio = *refine.aspect;
    refined.body.half_short_px = Combined(
        refined.body.half_short_px,
        {a.value * ratio.value,
         std::hypot(a.u * ratio.value, a.value * ratio.u), std::nullopt});
  }
  refiner.MeasurePoses(refined);
  Unwrap(refined);
  return refined;
}

}  // namespace touchdown::vision
