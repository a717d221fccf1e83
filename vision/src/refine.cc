#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "appearance.h"
#include "between_looks.h"
#include "body_cover.h"
#include "hidden_frames.h"
#include "outline_batch.h"
#include "shared_fit.h"
#include "touchdown/vision/tracker.h"
#include "track_shape.h"

namespace touchdown::vision {
namespace {

constexpr std::size_t kLeastSized = 3;  // frames that tell a size

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

void TakeSize(const BodyImage& from, BodyImage& to) {
  to.radius_px = from.radius_px;
  to.half_long_px = from.half_long_px;
  to.half_short_px = from.half_short_px;
}

class Refiner {
 public:
  Refiner(Clip& clip, const Background& background, const Track& track,
          const RefineOptions& refine)
      : clip_(clip),
        background_(background),
        track_(track),
        threads_(refine.threads),
        hidden_(clip, background, track) {
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
  // What the body looks like beyond its shading, where that is something;
  // `sized` are fits of a sample of frames, and are fitted again then.
  void LearnLook(Track& refined, std::vector<Fitted>& sized);
  bool LearnSpots(const BodyImage& body, std::vector<Fitted>& sized);
  bool LearnRim(const BodyImage& body, std::vector<Fitted>& sized);
  // The body as some frames show it.
  std::vector<Fitted> Sample(const BodyImage& body);

 private:
  std::vector<SeenOutline> Seen(const std::vector<Fitted>& fits) const;
  OutlineJob JobAt(const BodyImage& body, std::size_t i) const {
    const Pose& pose = track_.poses[i];
    const Motion& motion = motion_[i];
    return {pose.frame, OutlineAt(body, pose),
            core::PixelPoint{motion.x_px, motion.y_px}, motion.turn_rad};
  }
  // Blur and exposure, from fits of each frame, which it returns.
  std::vector<Fitted> LearnBlur(Track& refined);
  // The mean of the sizes that frames show; or one size, blur and exposure for
  // all of them at once. They return the fits; few or none where it fails.
  std::vector<Fitted> SizeByFrames(BodyImage& body);
  std::vector<Fitted> SizeTogether(BodyImage& body);
  void Follow(const SharedStep& step, BodyImage& body);
  bool LookForHider(const std::vector<Fitted>& whole, const BodyImage& body);
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
  HiddenFrames hidden_;
  OutlineOptions options_;
  std::vector<Motion> motion_;  // at each pose
  std::optional<Appearance> look_;
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
  std::vector<Fitted> near;
  for (const auto& fit :
       FitOutlines(clip_, background_, jobs, options_, threads_)) {
    if (!fit) continue;
    pixels += fit->fit.pixels_near_ground;
    excess += fit->fit.pixels_near_ground * fit->fit.excess_near_ground;
    near.push_back(*fit);
  }
  // A mean square of n residuals scatters by sqrt(2/n); in 1000 clips of even
  // ground it lay between 0.87 and 1.2, of those with a shadow at 2 and more.
  constexpr double kMostExcess = 1.25;
  constexpr double kSigmas = 4.0;
  // A body that is crudely modelled says nothing of what is near it.
  if (excess > kMostExcess * pixels + kSigmas * std::sqrt(2.0 * pixels) ||
      near.empty() || MedianMisfit(near) > kWellModelled) {
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
  std::vector<Fitted> sized = LearnBlur(refined);
  BodyImage body = refined.body;
  // Frames that a crude model shows say each something else: no joint fit of
  // them is better than their mean.
  const bool crude =
      sized.size() < kLeastSized || MedianMisfit(sized) > kWellModelled;
  if (!crude) {
    // From where the frames' own sizes are: a step is short then.
    const BodyImage shape = ShapeOf(sized, body.kind);
    if (IsSameSize(shape, track_.body)) TakeSize(shape, body);
  }
  sized = crude ? SizeByFrames(body) : SizeTogether(body);
  // Where frames that it hides a little still passed for whole, the next look
  // knows their place better.
  constexpr int kLooks = 3;
  for (int look = 0; look < kLooks && !crude && LookForHider(sized, body);
       ++look) {
    sized = SizeTogether(body);
    if (sized.size() < kLeastSized) break;
  }
  // Not with the shading held: its error is common to all frames, and what it
  // does to the size would not show in their scatter.
  if (sized.size() >= kLeastSized) options_.shading = ShadingOf(sized);
  if (sized.size() >= kLeastSized && IsSameSize(body, track_.body)) {
    refined.body = body;
  } else {
    options_.blur_px = refined.body.blur_px;
  }
}

std::vector<Fitted> Refiner::LearnBlur(Track& refined) {
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
  LearnLook(refined, sized);
  const double open = std::clamp(
      Shared(sized, &OutlineFit::open, &OutlineFit::u_open).value_or(0.0), 0.0,
      1.0);
  options_.open = 0.0;
  if (sized.size() >= kLeastSized &&
      IsSameSize(ShapeOf(sized, track_.body.kind), track_.body)) {
    if (options_.fit_open) options_.open = open;
    refined.body.blur_px =
        Shared(sized, &OutlineFit::blur_px, &OutlineFit::u_blur_px)
            .value_or(refined.body.blur_px);
  }
  options_.fit_open = false;
  options_.fit_blur = false;
  options_.blur_px = refined.body.blur_px;
  return sized;
}

void Refiner::LearnLook(Track& refined, std::vector<Fitted>& sized) {
  if (!track_.known_background) return;
  if (!LearnSpots(refined.body, sized) && !LearnRim(refined.body, sized)) {
    options_.appearance = nullptr;
    return;
  }
  options_.appearance = &*look_;
  // A body that is well modelled now tells more of what is near it.
  LookNearGround(refined);
}

bool Refiner::LearnSpots(const BodyImage& body, std::vector<Fitted>& sized) {
  // The first outlines are drawn aside by what they do not know; after the
  // third round nothing changes any more.
  constexpr int kRounds = 3;
  constexpr double kNearlyAll = 0.8;  // of the frames
  look_.reset();
  std::vector<Fitted> again = sized;
  for (int round = 0; round < kRounds; ++round) {
    auto look = LearnAppearance(clip_, background_, Seen(again), options_);
    if (!look) break;
    look_ = std::move(look);
    options_.appearance = &*look_;
    again = Sample(body);
  }
  if (!look_ ||
      static_cast<double>(again.size()) <
          kNearlyAll * static_cast<double>(sized.size()) ||
      MedianMisfit(again) > std::max(kWellModelled, MedianMisfit(sized))) {
    return false;
  }
  sized = std::move(again);
  return true;
}

bool Refiner::LearnRim(const BodyImage& body, std::vector<Fitted>& sized) {
  const double crude = MedianMisfit(sized);
  if (body.kind != core::BodyKind::kSphere || !(crude > kWellModelled)) {
    return false;
  }
  // Each round aligns the frames better to each other, or strays: the best
  // counts. A hoop's misfit fell to 0.6 where its poses became twice as smooth,
  // to 0.85 where they did not.
  constexpr int kRounds = 8;
  constexpr double kMuchBetter = 0.7;
  constexpr double kNearlyAll = 0.8;  // of the frames
  look_.reset();
  options_.appearance = nullptr;
  double least = kMuchBetter * crude;
  std::vector<Fitted> best;
  std::vector<Fitted> again = sized;
  std::optional<Appearance> look;
  for (int round = 0; round < kRounds; ++round) {
    look = LearnRings(clip_, background_, Seen(again), options_);
    if (!look) break;
    options_.appearance = &*look;
    again = Sample(body);
    if (static_cast<double>(again.size()) <
            kNearlyAll * static_cast<double>(sized.size()) ||
        MedianMisfit(again) > least) {
      continue;
    }
    least = MedianMisfit(again);
    best = again;
    look_ = look;
  }
  if (!look_) return false;
  sized = std::move(best);
  return true;
}

std::vector<SeenOutline> Refiner::Seen(const std::vector<Fitted>& fits) const {
  std::vector<SeenOutline> seen;
  std::size_t i = 0;  // both are in the frames' order
  for (const Fitted& f : fits) {
    while (i + 1 < track_.poses.size() && track_.poses[i].frame < f.frame) ++i;
    const Motion& motion = motion_[i];
    seen.push_back({f.frame, f.fit, core::PixelPoint{motion.x_px, motion.y_px},
                    motion.turn_rad});
  }
  return seen;
}

std::vector<Fitted> Refiner::SizeByFrames(BodyImage& body) {
  std::vector<Fitted> sized = Sample(body);
  if (sized.empty()) return sized;
  TakeSize(ShapeOf(sized, body.kind), body);
  return sized;
}

std::vector<Fitted> Refiner::SizeTogether(BodyImage& body) {
  options_.fit_size = false;
  options_.tell_shared = true;
  constexpr int kRounds = 3;
  constexpr double kNegligible = 0.1;  // of the uncertainty
  std::vector<Fitted> sized;
  double step = 1.0;
  for (int round = 0; round < kRounds && step > kNegligible; ++round) {
    sized = Sample(body);
    if (round == 0) hidden_.LeaveOut(sized);
    std::erase_if(sized, [&](const Fitted& f) { return hidden_.Has(f.frame); });
    const auto together = StepTogether(sized);
    if (!together) {
      sized.clear();
      break;
    }
    Follow(*together, body);
    step = std::abs(together->step[0]) / together->u[0];
  }
  options_.fit_size = true;
  options_.tell_shared = false;
  return sized;
}

void Refiner::Follow(const SharedStep& step, BodyImage& body) {
  const auto follow = [&](core::Estimate& value, int k) {
    value.value += step.step[k];
    value.u = step.u[k];
  };
  if (body.kind == core::BodyKind::kSphere) {
    follow(body.radius_px, 0);
  } else {
    follow(body.half_long_px, 0);
    follow(body.half_short_px, 1);
  }
  body.blur_px += step.step[2];
  options_.blur_px = body.blur_px;
  options_.open = std::clamp(options_.open + step.step[3], 0.0, 1.0);
}

bool Refiner::LookForHider(const std::vector<Fitted>& whole,
                           const BodyImage& body) {
  std::vector<OutlineJob> own;
  for (std::size_t i = 0; i < track_.poses.size(); ++i) {
    if (hidden_.Has(track_.poses[i].frame)) own.push_back(JobAt(body, i));
  }
  OutlineOptions held = options_;
  held.fit_size = false;
  const auto fits = FitOutlines(clip_, background_, own, held, threads_);
  if (!hidden_.LookForHider(whole, body, fits, held)) return false;
  options_.hider = hidden_.hider();
  return true;
}

void Refiner::MeasurePoses(Track& refined) {
  options_.fit_size = false;
  options_.fit_blur = false;
  options_.starts_near = true;
  refined.poses.clear();
  std::vector<Fitted> fits = Found(FitPoses(refined.body, 1));
  // Between two looks none has been asked yet whether it is of the body.
  if (track_.step > 1) DropStrangers(fits);
  std::erase_if(fits, [&](const Fitted& f) { return hidden_.Has(f.frame); });
  options_.starts_near = false;
  if (hidden_.hider() != nullptr) {
    hidden_.AddTo(fits, refined.body, options_);
  }
  refined.step = 1;
  for (const Fitted& fit : fits) {
    Pose better = PoseOf(fit);
    if (const auto pose = PoseIn(track_, fit.frame)) {
      better.relative_size = pose->relative_size;
    }
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
