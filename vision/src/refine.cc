#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "between_looks.h"
#include "body_cover.h"
#include "both_sides.h"
#include "follow_pattern.h"
#include "layers/layer_model.h"
#include "refiner.h"

namespace touchdown::vision {
namespace {

std::vector<Motion> MotionAtPoses(const std::vector<Pose>& poses) {
  std::vector<layers::LayerPose> path;
  std::vector<std::int64_t> frames;
  for (const Pose& pose : poses) {
    path.push_back({pose.centre.x_px, pose.centre.y_px, pose.angle_rad});
    frames.push_back(pose.frame);
  }
  std::vector<Motion> motions;
  for (const layers::LayerPose& step : layers::MotionsOf(path, frames)) {
    motions.push_back({step.x, step.y, step.angle_rad});
  }
  return motions;
}

}  // namespace

Refiner::Refiner(Clip& clip, const Background& background, const Track& track,
                 const RefineOptions& refine)
    : clip_(clip),
      background_(background),
      track_(track),
      threads_(refine.threads),
      hidden_(clip, background, track) {
  options_.surround = track.known_background
                          ? OutlineOptions::Surround::kBackground
                          : OutlineOptions::Surround::kPolynomial;
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
  motion_ = MotionAtPoses(track.poses);
}

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
  for (const std::size_t i : FromBothSides(low.size(), step)) {
    jobs.push_back(JobAt(track_.body, low[i]));
  }
  options_.near_ground = OutlineOptions::NearGround::kModelled;
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
    options_.near_ground = OutlineOptions::NearGround::kLeftOut;
    return;
  }
  refined.near_ground_modelled = true;
}

OutlineJob Refiner::JobAt(const BodyImage& body, std::size_t i) const {
  const Pose& pose = track_.poses[i];
  const Motion& motion = motion_[i];
  return {pose.frame, OutlineAt(body, pose),
          core::PixelPoint{motion.x_px, motion.y_px}, motion.turn_rad};
}

std::vector<std::optional<Fitted>> Refiner::FitPoses(const BodyImage& body,
                                                     std::size_t step) {
  std::vector<OutlineJob> jobs;
  for (const std::size_t i : FromBothSides(track_.poses.size(), step)) {
    jobs.push_back(JobAt(body, i));
  }
  return FitOutlines(clip_, background_, jobs, options_, threads_);
}

std::vector<Fitted> Refiner::Sample(const BodyImage& body) {
  constexpr std::size_t kEnough = 80;  // frames; u falls as 1/sqrt
  const std::size_t step =
      std::max<std::size_t>(1, track_.poses.size() / kEnough);
  std::vector<Fitted> all = Found(FitPoses(body, step));
  DropStrangers(all);
  return all;
}

void Refiner::MeasurePoses(Track& refined) {
  options_.fit_size = false;
  options_.fit_blur = false;
  options_.starts_near = true;
  refined.body.shutter_fraction = options_.open;
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

Track Refine(Clip& clip, const Background& background, const Track& given,
             const RefineOptions& refine) {
  // An outline of one face would sit on this part or that; layers leave nothing
  // to refine.
  if (!given.outlined || given.layered) return given;
  clip.cancellation().Enter("outlines are fitted with the ground known");
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
    refined.body.half_short_px = core::Combined(
        refined.body.half_short_px,
        {a.value * ratio.value,
         std::hypot(a.u * ratio.value, a.value * ratio.u), std::nullopt});
  }
  refiner.MeasurePoses(refined);
  Unwrap(refined);
  if (track.patterned) refined = PutOn(refined, track);
  return refined;
}

}  // namespace touchdown::vision
