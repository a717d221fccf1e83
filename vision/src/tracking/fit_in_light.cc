#include "tracking/fit_in_light.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>

#include "touchdown/vision/footage/linear_clip.h"

namespace touchdown::vision {
namespace {

using layers::FitLayersOptions;
using layers::LayerFit;
using layers::Shape;

// Cauchy's, at four standard deviations of the noise of the levels, which were
// fitted on `scale`.
std::function<double(float, float)> LossOfLevels(const LightScale& scale,
                                                 const Background& levels) {
  constexpr double kCut = 4.0;  // as layers::RobustWeight
  const double cut_dn = kCut * std::sqrt(levels.UsualVariance());
  return [scale, cut_dn](float level, float model) {
    const double off = (scale.ToLevel(level) - scale.ToLevel(model)) / cut_dn;
    return std::log1p(off * off);
  };
}

// The camera's gamma as outlines show it; 1: that of a linear one. None has
// more.
double SeenGamma(const LayerFit& fit) {
  return 1.0 / (1.0 + std::max(fit.curve.value_or(0.0), 0.0));
}

// Of levels as they are, or of light.
LightScale ScaleOf(const Clip& clip, const std::optional<double>& gamma) {
  LightScale scale = MakeLightScale(clip.info().bit_depth, gamma.value_or(1.0));
  if (!gamma) scale.full_light_dn = scale.full_level_dn;
  return scale;
}

// Layers of levels of one scale, in levels of another; B is that of `evidence`.
LayerFit StartInLight(const LayerFit& fit, const LightScale& was,
                      const LightScale& is, const LayerEvidence& evidence,
                      double noise_ratio) {
  LayerFit start;
  start.poses = fit.poses;
  start.layers = fit.layers;
  layers::Layers& layers = start.layers;
  layers.still = evidence.still;
  layers.noise_dn *= noise_ratio;
  const auto change = [&](double level) {
    return is.ToLight(was.ToLevel(level));
  };
  double level = layers.quadratic[0];
  if (!layers.flat) {
    level = 0.0;
    for (float& node : layers.picture) {
      level += node;
      node = static_cast<float>(change(node));
    }
    level /= static_cast<double>(layers.picture.size());
  }
  constexpr double kNear_dn = 0.5;  // of a difference quotient
  const double slope = change(level + kNear_dn) - change(level - kNear_dn);
  layers.quadratic[0] = change(layers.quadratic[0]);
  for (std::size_t k = 1; k < layers::kTerms; ++k) layers.quadratic[k] *= slope;
  layers.slope_x *= slope;
  layers.slope_y *= slope;
  layers.texture.deviation_dn *= slope;
  return start;
}

// The light of a camera of such a gamma, from the layers of `last`, which are
// of another.
LightFit FitLight(Clip& clip, const Background& background, const Shape& shape,
                  double gamma, const LightFit& last,
                  FitLayersOptions options) {
  const LightScale scale = ScaleOf(clip, gamma);
  const Background seen = InLight(background, scale);
  const layers::Layers& layers = last.fit.layers;
  LightFit light;
  light.gamma = gamma;
  light.light = ViewInLight(clip, gamma);
  const LayerEvidence& was = last.evidence;
  light.evidence = ReadEvidence(*light.light, seen, was.box,
                                {was.path.frames, last.fit.poses}, shape);
  const LayerEvidence& evidence = light.evidence;
  layers::SetOptics(layers.blur, layers.exposure, options.prior);
  options.lines = FindLines(seen, evidence, shape, layers.blur);
  options.loss = LossOfLevels(scale, background);
  light.fit =
      ImproveLayers(evidence.stack,
                    StartInLight(last.fit, ScaleOf(clip, last.gamma), scale,
                                 evidence, evidence.noise_dn / was.noise_dn),
                    options);
  return light;
}

}  // namespace

double OutlinesBeside(const LayerFit& fit, const BodySize& size) {
  const Shape& shape = fit.layers.shape;
  const auto beside = [](double half_px, const core::Estimate& stated) {
    const double off = half_px - 0.5 * stated.value;
    const double u = 0.5 * stated.u;
    return std::sqrt(std::max(0.0, off * off - u * u));
  };
  const double across = beside(shape.half_long, size.long_px);
  const double along =
      shape.disc ? 0.0 : beside(shape.half_short, size.short_px);
  return std::hypot(fit.beyond_px, std::max(across, along));
}

bool IsBetterInLight(const LayerFit& light, const LayerFit& before,
                     const std::optional<BodySize>& size) {
  // Of the loss: a fit that has not settled yet is off by so much. Larger takes
  // light by the sides alone. Not studied.
  constexpr double kAlike = 0.01;
  // Ratio of the distances. Larger takes light for noise of the outlines. Not
  // studied.
  constexpr double kMuchNearer = 0.5;
  if (!size) return light.loss < before.loss;
  const double beside_px = OutlinesBeside(light, *size);
  const double before_px = OutlinesBeside(before, *size);
  return (light.loss < before.loss && beside_px <= before_px) ||
         (light.loss < (1.0 + kAlike) * before.loss &&
          beside_px < kMuchNearer * before_px);
}

LightFit FitLevelsThenLight(Clip& clip, const Background& background,
                            const Shape& shape, LayerEvidence evidence,
                            const std::optional<BodySize>& size,
                            FitLayersOptions options) {
  // Of a gamma: nearer to 1, what it does to outlines is within their u.
  constexpr double kClearlyNot1 = 0.72;
  constexpr double kLeast = 0.3;  // no camera has less: the outlines err
  // In light with the camera's own gamma outlines still show 0.9 to 1.
  constexpr double kNear1 = 0.9;
  // First order is not exact: what remains is measured again.
  constexpr int kRounds = 2;
  LightFit best;
  best.evidence = std::move(evidence);
  options.loss = LossOfLevels(ScaleOf(clip, best.gamma), background);
  best.fit = FitLayers(best.evidence.stack, shape, best.evidence.path.poses,
                       best.evidence.still, best.evidence.noise_dn, options);
  double gamma = SeenGamma(best.fit);
  if (clip.info().in_light || gamma > kClearlyNot1) return best;
  double more = gamma;
  for (int round = 0; round < kRounds && more < kNear1 && gamma >= kLeast;
       ++round) {
    clip.cancellation().Check();
    LightFit light = FitLight(clip, background, shape, gamma, best, options);
    if (!IsBetterInLight(light.fit, best.fit, size)) break;
    best = std::move(light);
    more = SeenGamma(best.fit);
    gamma *= more;
  }
  return best;
}

}  // namespace touchdown::vision
