#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "refiner.h"
#include "robust.h"

namespace touchdown::vision {
namespace {

constexpr std::size_t kLeastSized = 3;  // frames that tell a size

// One coefficient over the frames: its median, and how far a frame's own may
// lie from it beyond the fits' noise.
void PriorOf(const std::vector<double>& values, const std::vector<double>& us,
             double& level, double& u) {
  level = Median(values);
  std::vector<double> off;
  off.reserve(values.size());
  for (const double v : values) off.push_back(std::abs(v - level));
  const double scatter = kSigmaPerMedian * Median(off);
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

}  // namespace

void Refiner::LearnShape(Track& refined) {
  std::vector<Fitted> sized = LearnBlur(refined);
  BodyImage body = refined.body;
  const double open = options_.open;
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
    options_.open = open;
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

}  // namespace touchdown::vision
