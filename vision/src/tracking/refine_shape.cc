#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "numbers/robust.h"
#include "tracking/refiner.h"

namespace touchdown::vision {
namespace {

// Frames that tell a size: with fewer there is no scatter to give its u.
constexpr std::size_t kMinSized = 3;

// Prior of one shading coefficient: its median over the frames, and how far the
// coefficient of one frame may lie from it beyond the noise of the fits.
void EstimatePrior(const std::vector<double>& values,
                   const std::vector<double>& us, double& level, double& u) {
  level = Median(values);
  std::vector<double> off;
  off.reserve(values.size());
  for (const double v : values) off.push_back(std::abs(v - level));
  const double scatter = kSigmaPerMedian * Median(off);
  const double noise = Median(us);
  const double own = std::max(0.0, scatter * scatter - noise * noise);
  // Variance of a median: pi/2 times the mean's.
  const double n = static_cast<double>(values.size());
  u = std::sqrt(own + 1.5708 * noise * noise / n);
}

// The shading that frames which show the body whole agree on; nothing where
// these are few.
std::optional<Shading> AverageShading(const std::vector<Fitted>& all) {
  // Frames: fewer give no scatter for EstimatePrior. Not studied.
  constexpr std::size_t kMinWhole = 8;
  std::vector<const OutlineFit*> whole;
  for (const Fitted& f : all) {
    if (f.fit.visible >= kWhollySeen && f.fit.shading) whole.push_back(&f.fit);
  }
  if (whole.size() < kMinWhole) return std::nullopt;
  Shading shading;
  for (std::size_t k = 0; k < shading.level.size(); ++k) {
    std::vector<double> values;
    std::vector<double> us;
    for (const OutlineFit* fit : whole) {
      values.push_back(fit->shading->level[k]);
      us.push_back(fit->shading->u[k]);
    }
    EstimatePrior(values, us, shading.level[k], shading.u[k]);
    if (!(shading.u[k] > 0.0)) return std::nullopt;
  }
  return shading;
}

// The variance t^2 of which coefficients c_k, known to u_k, were most likely
// drawn about 0, by expectation and maximisation: the mean of  m^2 + v,  where
// coefficient k has the mean m and the variance v after c_k was seen.
double MostLikelyVariance(std::span<const double> c,
                          std::span<const double> u) {
  // Where t is below u each step takes off a share t^2 / u^2: what is left
  // after so many is a tenth of u.
  constexpr int kSteps = 100;
  const double n = static_cast<double>(c.size());
  double square = std::inner_product(c.begin(), c.end(), c.begin(), 0.0) / n;
  for (int step = 0; step < kSteps; ++step) {
    double sum = 0.0;
    for (std::size_t k = 0; k < c.size(); ++k) {
      const double share = square / (square + u[k] * u[k]);
      sum += share * share * c[k] * c[k] + share * u[k] * u[k];
    }
    square = sum / n;
  }
  return square;
}

// How the body may be shaded (empirical Bayes): beside its level none, but for
// the variance about 0 that frames show which were fitted without a prior, and
// for what changes from frame to frame. Nothing where frames that show the body
// whole are few.
std::optional<Shading> LearnShadingVariance(const std::vector<Fitted>& all) {
  std::optional<Shading> shading = AverageShading(all);
  if (!shading) return std::nullopt;
  // A prior that n frames share has n times the variance in each.
  const double shared =
      std::sqrt(static_cast<double>(all.size()) *
                MostLikelyVariance(std::span(shading->level).subspan(1),
                                   std::span(shading->u).subspan(1)));
  shading->level.fill(0.0);
  for (double& u : shading->u) u = std::hypot(u, shared);
  constexpr double kFree_dn = 1e6;  // more than any camera's levels
  shading->u[0] = kFree_dn;
  return shading;
}

// Robust mean over the frames of what they share of the camera (blur,
// exposure).
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

// Whether a free fit kept the size: a body that is no sphere or rectangle, or
// lies behind others, may lose it, and what was found first is kept then.
bool IsSameSize(const BodyImage& again, const BodyImage& found) {
  // Relative change of a half side, and its relative u. Larger lets a lost size
  // through. Not studied.
  constexpr double kMaxChange = 0.2;
  constexpr double kMaxRelativeU = 0.05;
  const auto same = [&](const core::Estimate& a, const core::Estimate& b) {
    return std::abs(a.value - b.value) <= kMaxChange * b.value &&
           a.u <= kMaxRelativeU * b.value;
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

}  // namespace

// Size, blur, exposure and shading that all frames share, in this order: blur
// and exposure from separate fits; the size by one joint fit where the model
// explains the pixels, else by the mean of the frames; frames that an obstacle
// hides in part leave, and the joint fit is made again; the shading last.
void Refiner::LearnShape(Track& refined) {
  std::vector<Fitted> sized = LearnBlur(refined);
  BodyImage body = refined.body;
  const double open = options_.open;
  // A crude model errs otherwise in each frame: no joint fit of such frames is
  // better than their mean.
  const bool crude =
      sized.size() < kMinSized || MedianMisfit(sized) > kWellModelled;
  if (!crude) {
    // Start where the frames' own sizes are: the joint fit then needs a short
    // step.
    const BodyImage shape = EstimateShape(sized, body.kind);
    if (IsSameSize(shape, track_.body)) TakeSize(shape, body);
    options_.shading = LearnShadingVariance(sized);
  }
  sized = crude ? SizeByFrames(body) : SizeTogether(body);
  // Frames that an obstacle hides a little may still pass for whole: each
  // search knows their place better than the one before. Not studied.
  constexpr int kMaxSearches = 3;
  for (int look = 0; look < kMaxSearches && !crude && LookForHider(sized, body);
       ++look) {
    sized = SizeTogether(body);
    if (sized.size() < kMinSized) break;
  }
  // The size is not fitted with the shading held: an error of the shading is
  // common to all frames, and what it does to the size would not show in their
  // scatter.
  options_.shading =
      sized.size() >= kMinSized ? AverageShading(sized) : std::nullopt;
  if (sized.size() >= kMinSized && IsSameSize(body, track_.body)) {
    refined.body = body;
  } else {
    options_.blur_px = refined.body.blur_px;
    options_.open = open;
  }
}

std::vector<Fitted> Refiner::LearnBlur(Track& refined) {
  // The exposure can be fitted only where the body moves by enough of its blur
  // in a frame interval: half of the frames by one blur_px.
  std::vector<double> ways;
  for (const Motion& motion : motion_) {
    ways.push_back(std::hypot(motion.x_px, motion.y_px));
  }
  options_.fit_blur = true;
  options_.fit_open = Median(ways) > track_.body.blur_px;
  // Share of the frame interval: start value of the fit. Not studied.
  constexpr double kStartShutter = 0.3;
  if (options_.fit_open) options_.open = kStartShutter;
  std::vector<Fitted> sized = Sample(refined.body);
  LearnLook(refined, sized);
  const double open = std::clamp(
      Shared(sized, &OutlineFit::open, &OutlineFit::u_open).value_or(0.0), 0.0,
      1.0);
  options_.open = 0.0;
  if (sized.size() >= kMinSized &&
      IsSameSize(EstimateShape(sized, track_.body.kind), track_.body)) {
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

std::vector<Fitted> Refiner::SizeByFrames(BodyImage& body) {
  std::vector<Fitted> sized = Sample(body);
  if (sized.empty()) return sized;
  TakeSize(EstimateShape(sized, body.kind), body);
  return sized;
}

// Gauss-Newton on what all frames share: each round fits every frame with the
// shared parameters held, then takes one joint step of them (shared_fit.h).
std::vector<Fitted> Refiner::SizeTogether(BodyImage& body) {
  options_.fit_size = false;
  options_.tell_shared = true;
  // A bound on time; the step that is left is below its u. Not studied.
  constexpr int kMaxRounds = 3;
  // In units of the size's u: a smaller step changes nothing that is reported.
  constexpr double kNegligibleStep = 0.1;
  std::vector<Fitted> sized;
  double step = 1.0;
  for (int round = 0; round < kMaxRounds && step > kNegligibleStep; ++round) {
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

// Takes the joint step: sizes, blur and shutter (held within 0..1).
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

// Fits hidden frames at the body's size, which shows where the body is there,
// and seeks the obstacle before it.
bool Refiner::LookForHider(const std::vector<Fitted>& whole,
                           const BodyImage& body) {
  std::vector<OutlineJob> own;
  for (std::size_t i = 0; i < track_.poses.size(); ++i) {
    if (hidden_.Has(track_.poses[i].frame)) own.push_back(MakeJob(body, i));
  }
  OutlineOptions held = options_;
  held.fit_size = false;
  const auto fits = FitOutlines(clip_, background_, own, held, threads_);
  if (!hidden_.LookForHider(whole, body, fits, held)) return false;
  options_.hider = hidden_.hider();
  return true;
}

}  // namespace touchdown::vision
