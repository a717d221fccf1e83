#include "tracking/fit_in_light.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>

#include "touchdown/vision/footage/linear_clip.h"
#include "tracking/unknown_gamma.h"

namespace touchdown::vision {
namespace {

using layers::FitLayersOptions;
using layers::LayerFit;
using layers::LayerPose;
using layers::Shape;

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
  light.fit =
      ImproveLayers(evidence.stack,
                    StartInLight(last.fit, ScaleOf(clip, last.gamma), scale,
                                 evidence, evidence.noise_dn / was.noise_dn),
                    options);
  return light;
}

// Where poses lie beside others of the same pictures, in the body's axes: the
// mean.
LayerPose MeanBeside(const std::vector<LayerPose>& poses,
                     const std::vector<LayerPose>& others) {
  LayerPose mean;
  const double share = 1.0 / static_cast<double>(poses.size());
  for (std::size_t t = 0; t < poses.size(); ++t) {
    const double x = poses[t].x - others[t].x;
    const double y = poses[t].y - others[t].y;
    const double cosine = std::cos(others[t].angle_rad);
    const double sine = std::sin(others[t].angle_rad);
    mean.x += share * (cosine * x + sine * y);
    mean.y += share * (cosine * y - sine * x);
    mean.angle_rad += share * (poses[t].angle_rad - others[t].angle_rad);
  }
  return mean;
}

// What fits of one clip cost, in levels or in light.
class GammaCost {
 public:
  // `levels`: the first fit, which the others are compared with.
  GammaCost(const Clip& clip, const layers::SharedPrior& prior,
            const LightFit& levels)
      : clip_(clip),
        prior_(prior),
        first_poses_(levels.fit.poses),
        noise_dn_(levels.fit.layers.noise_dn) {
    // By which share the loss of a camera's own gamma exceeds the least, in
    // photographed clips: little where layers explain the levels to the noise,
    // more with what they do not explain, up to what it is in codecs' clips.
    // Larger leaves a gamma open, smaller is sure of a wrong one.
    constexpr double kShare = 0.001;
    constexpr double kOfUnexplained = 0.01;
    constexpr double kMostShare = 0.01;
    const double misfit = noise_dn_ / levels.evidence.noise_dn;
    const double unexplained = std::max(0.0, misfit * misfit - 1.0);
    unit_ = 2.0 * MeasureLoss(levels) *
            std::min(kShare + kOfUnexplained * unexplained, kMostShare);
  }

  GammaTrial Judge(const LightFit& fit) const {
    const Shape& shape = fit.fit.layers.shape;
    return {std::log(fit.gamma.value_or(1.0)),
            MeasureLoss(fit) / unit_ +
                CostOfSide(layers::kLong, shape.half_long) +
                CostOfSide(layers::kShort, shape.half_short),
            {shape.half_long, shape.half_short,
             MeanBeside(fit.fit.poses, first_poses_)}};
  }

 private:
  // Cauchy's, at four standard deviations of what the first fit left of the
  // levels.
  double MeasureLoss(const LightFit& fit) const {
    constexpr double kCut = 4.0;  // standard deviations, as in RobustWeight
    const double cut_dn = kCut * noise_dn_;
    const LightScale scale = ScaleOf(clip_, fit.gamma);
    return layers::MeanLoss(
        fit.evidence.stack, fit.fit, [&](float level, float model) {
          const double off =
              (scale.ToLevel(level) - scale.ToLevel(model)) / cut_dn;
          return std::log1p(off * off);
        });
  }

  // Of a side that lies beside what is known of it. Cauchy's: a misstated size
  // must not outweigh what the pixels say of gamma.
  double CostOfSide(layers::SharedParameter side, double half_px) const {
    // What outlines of flat bodies are off.
    constexpr double kOutline_px = 0.03;
    const double u = prior_.u[side];
    if (!(u > 0.0)) return 0.0;
    const double off =
        (half_px - prior_.value[side]) / std::hypot(u, kOutline_px);
    return std::log1p(0.5 * off * off);
  }

  const Clip& clip_;
  const layers::SharedPrior& prior_;
  std::vector<LayerPose> first_poses_;
  double noise_dn_ = 1.0;
  double unit_ = 1.0;  // of the loss: one standard deviation of gamma costs 1/2
};

std::vector<GammaTrial>::const_iterator FindCheapest(
    const std::vector<GammaTrial>& trials) {
  return std::min_element(
      trials.begin(), trials.end(),
      [](const GammaTrial& a, const GammaTrial& b) { return a.cost < b.cost; });
}

// Second derivative of the cost by three trials, the second of which costs
// least, and where it is least.
struct Parabola {
  double lowest = 0.0;
  double curvature = 0.0;
};
Parabola FitParabola(const GammaTrial& a, const GammaTrial& b,
                     const GammaTrial& c) {
  const double ab = (b.cost - a.cost) / (b.log_gamma - a.log_gamma);
  const double bc = (c.cost - b.cost) / (c.log_gamma - b.log_gamma);
  const double curvature = 2.0 * (bc - ab) / (c.log_gamma - a.log_gamma);
  return {0.5 * (a.log_gamma + b.log_gamma) - ab / curvature, curvature};
}

}  // namespace

double FindLeastLogGamma(const std::vector<GammaTrial>& trials) {
  const Parabola parabola = FitParabola(trials[0], trials[1], trials[2]);
  // Where it falls ever more steeply, the last is the best so far.
  return parabola.curvature > 0.0
             ? std::clamp(parabola.lowest, std::log(kLeastGamma), 0.0)
             : trials.back().log_gamma;
}

double LogGammaUncertainty(std::vector<GammaTrial> trials) {
  // From the largest gamma to the least.
  std::sort(trials.begin(), trials.end(),
            [](const GammaTrial& a, const GammaTrial& b) {
              return a.log_gamma > b.log_gamma;
            });
  const auto best = FindCheapest(trials);
  const double slab = -std::log(kLeastGamma);
  const double most = slab / std::sqrt(3.0);  // of any gamma in it
  if (trials.size() < 2) return most;
  if (best == trials.begin()) {
    const double steep =
        (best[1].cost - best->cost) / (best->log_gamma - best[1].log_gamma);
    return std::min(most, std::sqrt(2.0 / (slab * steep)) / steep);
  }
  const auto middle = best + 1 == trials.end() ? best - 1 : best;
  if (middle == trials.begin()) return most;
  const double curvature =
      FitParabola(middle[-1], *middle, middle[1]).curvature;
  return curvature > 0.0 ? std::min(most, 1.0 / std::sqrt(curvature)) : most;
}

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

LightFit FitLevelsOrLight(Clip& clip, const Background& background,
                          const Shape& shape, LayerEvidence evidence,
                          const FitLayersOptions& options) {
  LightFit best;
  best.evidence = std::move(evidence);
  best.fit = FitLayers(best.evidence.stack, shape, best.evidence.path.poses,
                       best.evidence.still, best.evidence.noise_dn, options);
  if (clip.info().gamma_is_known) return best;
  const GammaCost cost(clip, options.prior, best);
  // The middle of an edge from black to white lies 1.3 blurs off at the least
  // gamma. Sides that moved farther are those of a fit that went astray.
  constexpr double kMostBlurs = 1.5;
  const double most_px = kMostBlurs * best.fit.layers.blur;
  std::vector<GammaTrial> trials = {cost.Judge(best)};
  const auto attempt = [&](double log_gamma) {
    clip.cancellation().Check();
    LightFit light =
        FitLight(clip, background, shape, std::exp(log_gamma), best, options);
    const GammaTrial trial = cost.Judge(light);
    const SidesInLight& in_levels = trials[0].sides;
    if (std::max(std::abs(trial.sides.half_long_px - in_levels.half_long_px),
                 std::abs(trial.sides.half_short_px -
                          in_levels.half_short_px)) > most_px) {
      return;
    }
    const double least = FindCheapest(trials)->cost;
    trials.push_back(trial);
    if (trial.cost < least) best = std::move(light);
  };
  // Half way to what most cameras have that are not linear: IEC 61966-2-1 and
  // ITU-R BT.709 are near 0.45.
  attempt(std::log(0.7));
  if (best.gamma) attempt(std::log(0.45));
  if (trials.size() > 2) {
    const double lowest = FindLeastLogGamma(trials);
    constexpr double kNear = 0.1;  // a gamma that was tried does as well
    if (std::none_of(trials.begin(), trials.end(), [&](const GammaTrial& at) {
          return std::abs(at.log_gamma - lowest) < kNear;
        })) {
      attempt(lowest);
    }
  }
  if (trials.size() < 2) return best;
  const auto [low, high] =
      std::minmax_element(trials.begin(), trials.end(),
                          [](const GammaTrial& a, const GammaTrial& b) {
                            return a.log_gamma < b.log_gamma;
                          });
  const double share =
      LogGammaUncertainty(trials) / (high->log_gamma - low->log_gamma);
  const SidesInLight& most = high->sides;
  const SidesInLight& least = low->sides;
  const auto moved = [&](double SidesInLight::*value) {
    return (most.*value - least.*value) * share;
  };
  best.u.half_long_px = moved(&SidesInLight::half_long_px);
  best.u.half_short_px = moved(&SidesInLight::half_short_px);
  best.u.pose = {(most.pose.x - least.pose.x) * share,
                 (most.pose.y - least.pose.y) * share,
                 (most.pose.angle_rad - least.pose.angle_rad) * share};
  return best;
}

}  // namespace touchdown::vision
