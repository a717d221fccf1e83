#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "layers/layer_model.h"
#include "numbers/both_sides.h"
#include "outline/body_cover.h"
#include "track/image_size.h"
#include "tracking/between_looks.h"
#include "tracking/follow_pattern.h"
#include "tracking/refiner.h"
#include "tracking/unknown_gamma.h"

namespace touchdown::vision {
namespace {

// Displacement and turn per frame at each pose, as the exposure smears them.
std::vector<Motion> MotionAtPoses(const std::vector<Pose>& poses) {
  std::vector<layers::LayerPose> path;
  std::vector<std::int64_t> frames;
  for (const Pose& pose : poses) {
    path.push_back({pose.centre.x_px, pose.centre.y_px, pose.angle_rad});
    frames.push_back(pose.frame);
  }
  std::vector<Motion> motions;
  for (const layers::LayerPose& step : layers::EstimateMotions(path, frames)) {
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
  // In units of blur_px (sigma): nearer to the ground its blurred edge adds to
  // the body's, and the two do not superpose. Larger loses the lower edge of
  // flat bodies; at 2.5 less than 1 % of an edge's step is left (normal
  // distribution).
  constexpr double kMarginBlurs = 2.5;
  // Share of half the short side: half of the body is always left. From
  // geometry.
  constexpr double kMaxMarginShare = 1.0;
  const double half = track.body.kind == core::BodyKind::kSphere
                          ? track.body.radius_px.value
                          : track.body.half_short_px.value;
  options_.ground_margin_px = std::max(
      options_.ground_margin_px,
      std::min(kMarginBlurs * track.body.blur_px, kMaxMarginShare * half));
  motion_ = MotionAtPoses(track.poses);
}

// Near the ground the picture is modelled as out + c (in - behind), where
// `behind` is the background above the ground's blurred edge. That is exact
// while the body is above the line and nothing else changes there; a shadow
// refutes it. Whether it holds is asked of the residuals near the ground.
void Refiner::LookNearGround(Track& refined) {
  refined.near_ground_modelled = false;
  // px of the ground's wave: what a body hides of a wavier edge is no level
  // line. Not studied.
  constexpr double kMaxWave_px = 0.1;
  if (!track_.known_background || !options_.ground ||
      options_.ground->wave_px > kMaxWave_px) {
    return;
  }
  // Poses that reach down to the ground, evenly spread: some thousand pixels in
  // all, which is enough for the test below. More cost time.
  constexpr std::size_t kMaxLowPoses = 40;
  std::vector<std::size_t> low;
  for (std::size_t i = 0; i < track_.poses.size(); ++i) {
    const Pose& pose = track_.poses[i];
    const Outline outline = PlaceOutline(track_.body, pose);
    const double gap =
        calib::HeightAboveLine(*options_.ground, pose.centre) -
        SupportHeight(outline, calib::ImageAngle(*options_.ground));
    if (gap < options_.ground_margin_px) low.push_back(i);
  }
  const std::size_t step = (low.size() + kMaxLowPoses - 1) / kMaxLowPoses;
  std::vector<OutlineJob> jobs;
  for (const std::size_t i : FromBothSides(low.size(), step)) {
    jobs.push_back(MakeJob(track_.body, low[i]));
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
  // Mean square of the residuals near the ground over that of the others.
  // Smaller leaves the lower edge out without need; larger takes a shadow for
  // body. In 1000 clips of even ground it lay between 0.87 and 1.2, with a
  // shadow at 2 and more.
  constexpr double kMaxExcess = 1.25;
  // A mean square of n residuals scatters by sqrt(2/n): so many times that is
  // allowed in addition, for few pixels. Not studied.
  constexpr double kScatterSigmas = 4.0;
  if (excess > kMaxExcess * pixels + kScatterSigmas * std::sqrt(2.0 * pixels) ||
      near.empty() || MedianMisfit(near) > kWellModelled) {
    options_.near_ground = OutlineOptions::NearGround::kLeftOut;
    return;
  }
  refined.near_ground_modelled = true;
}

OutlineJob Refiner::MakeJob(const BodyImage& body, std::size_t i) const {
  const Pose& pose = track_.poses[i];
  const Motion& motion = motion_[i];
  return {pose.frame, PlaceOutline(body, pose),
          core::PixelPoint{motion.x_px, motion.y_px}, motion.turn_rad};
}

std::vector<std::optional<Fitted>> Refiner::FitPoses(const BodyImage& body,
                                                     std::size_t step) {
  std::vector<OutlineJob> jobs;
  for (const std::size_t i : FromBothSides(track_.poses.size(), step)) {
    jobs.push_back(MakeJob(body, i));
  }
  return FitOutlines(clip_, background_, jobs, options_, threads_);
}

// Fits of frames spread evenly over the track, enough for what all frames
// share.
std::vector<Fitted> Refiner::Sample(const BodyImage& body) {
  // Frames. The u of what they share falls as 1/sqrt of their number; the time
  // grows with it. Not studied.
  constexpr std::size_t kSampleFrames = 80;
  const std::size_t step =
      std::max<std::size_t>(1, track_.poses.size() / kSampleFrames);
  std::vector<Fitted> all = Found(FitPoses(body, step));
  DropStrangers(all);
  return all;
}

// The last fit of each frame: size, blur and exposure are known and held, the
// place and attitude are free.
void Refiner::MeasurePoses(Track& refined) {
  options_.fit_size = false;
  options_.fit_blur = false;
  options_.starts_near = true;
  refined.body.shutter_fraction = options_.open;
  refined.poses.clear();
  std::vector<Fitted> fits = Found(FitPoses(refined.body, 1));
  // Interpolated frames have not been tested for outliers yet.
  if (track_.step > 1) DropStrangers(fits);
  std::erase_if(fits, [&](const Fitted& f) { return hidden_.Has(f.frame); });
  options_.starts_near = false;
  if (hidden_.hider() != nullptr) {
    hidden_.AddFits(fits, refined.body, options_);
  }
  refined.step = 1;
  for (const Fitted& fit : fits) {
    Pose better = ToPose(fit);
    if (const auto pose = InterpolatePose(track_, fit.frame)) {
      better.relative_size = pose->relative_size;
    }
    refined.poses.push_back(better);
  }
}

Track Refine(Clip& clip, const Background& background, const Track& given,
             const RefineOptions& refine) {
  // Outlines of one face would sit on this part or that of a body of several
  // parts, and a layered track leaves nothing to refine.
  if (!given.outlined || given.layered) return given;
  clip.cancellation().Enter("outlines are fitted with the ground known");
  const Track track = Bridged(given);
  Track refined = track;
  Refiner refiner(clip, background, track, refine);
  refiner.LookNearGround(refined);
  if (IsSteady(track)) {
    refiner.LearnShape(refined);
  } else {
    // A body that comes to the ground seems to change its size where the
    // ground's edge was taken for its own: the change is measured once more
    // with the ground left out. If none is left, the track is steady.
    Track again = track;
    KeepSize(again);
    FollowSize(refiner.Sample(track.body), again);
    if (IsSteady(again)) return Refine(clip, background, again, refine);
  }
  if (refine.aspect && track.body.kind == core::BodyKind::kRectangle &&
      track.body.whole_px == 0.0) {
    const core::Estimate& a = refined.body.half_long_px;
    const core::Estimate& ratio = *refine.aspect;
    // The stated ratio of the sides is a second measurement of the short side.
    refined.body.half_short_px = core::Combined(
        refined.body.half_short_px,
        {a.value * ratio.value,
         std::hypot(a.u * ratio.value, a.value * ratio.u), std::nullopt});
  }
  if (!refine.size_is_stated) {
    TakeUnknownGamma(clip.info(), background, refined);
    // Sides whose ratio is stated move in that ratio.
    if (refine.aspect) refined.body.gamma_short_px *= refine.aspect->value;
  }
  refiner.MeasurePoses(refined);
  Unwrap(refined);
  if (track.patterned) refined = AlignToOutlines(refined, track);
  return refined;
}

}  // namespace touchdown::vision
