#include "layers/fit_layers.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "layers/texture.h"
#include "touchdown/core/parallel.h"

namespace touchdown::vision::layers {
namespace {

// Blurs of the rim of T's grid: coverage beyond is nothing.
constexpr double kRimBlurs = 3.5;

// All derivatives of all frames, about the edges that B has now; takes the
// place of what `frames` held. `clear`: how often B was seen without the body.
void LinearizeAll(const PictureStack& stack, Layers& layers,
                  const std::vector<float>& clear,
                  const std::vector<LayerPose>& poses,
                  const FitLayersOptions& options,
                  std::vector<FrameSamples>& frames) {
  layers.edges = FindStillEdges(
      {layers.still.data(), clear, stack.width, stack.height}, options.lines,
      layers.blur, kLeastStillStep * layers.noise_dn);
  const std::vector<LayerPose> motions = EstimateMotions(poses, stack.frames);
  frames.resize(poses.size());
  core::InParallel(static_cast<std::int64_t>(poses.size()), options.threads,
                   [&](std::int64_t begin, std::int64_t end) {
                     for (auto t = static_cast<std::size_t>(begin);
                          t < static_cast<std::size_t>(end); ++t) {
                       Linearize(stack, t, layers, poses[t], motions[t],
                                 Derivatives::kAll, frames[t]);
                     }
                   });
}

// Root mean square of the residuals, those beyond four standard deviations
// counted as that.
double MeasureNoise(const std::vector<FrameSamples>& frames, double before) {
  // Standard deviations, as in RobustWeight.
  constexpr double kCut = 4.0;
  double sum = 0.0;
  double count = 0.0;
  for (const FrameSamples& samples : frames) {
    for (const float residual : samples.residual) {
      const double off =
          std::min(std::abs(static_cast<double>(residual)), kCut * before);
      sum += off * off;
      count += 1.0;
    }
  }
  constexpr double kRounding = 0.29;  // DN: of whole numbers
  return count > 0.0 ? std::max(std::sqrt(sum / count), kRounding) : before;
}

// Cauchy's weights at four standard deviations.
void Reweigh(double noise_dn, std::vector<FrameSamples>& frames) {
  for (FrameSamples& samples : frames) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      samples.weight[i] = RobustWeight(samples.residual[i], noise_dn);
    }
  }
}

// Where a body is seen alone: at one pose.
struct SeenAlone {
  const ShapeCover& cover;
  float x, y, cosine, sine;
  SeenAlone(const ShapeCover& of, const LayerPose& at)
      : cover(of),
        x(static_cast<float>(at.x)),
        y(static_cast<float>(at.y)),
        cosine(static_cast<float>(std::cos(at.angle_rad))),
        sine(static_cast<float>(std::sin(at.angle_rad))) {}
  bool At(std::int32_t column, std::int32_t row) const {
    constexpr float kWhole = 0.95F;  // coverage
    const float dx = static_cast<float>(column) - x;
    const float dy = static_cast<float>(row) - y;
    return cover.At(cosine * dx + sine * dy, cosine * dy - sine * dx).value >=
           kWhole;
  }
};

// The mean level of the pixels that see the body alone from the beginning of
// the exposure to its end.
double MeanLevel(const PictureStack& stack, const Layers& layers,
                 const std::vector<LayerPose>& poses) {
  const ShapeCover cover(layers.shape, layers.blur);
  const std::vector<LayerPose> motions = EstimateMotions(poses, stack.frames);
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t t = 0; t < poses.size(); ++t) {
    const auto after = [&](double frames) {
      return LayerPose{poses[t].x + frames * motions[t].x,
                       poses[t].y + frames * motions[t].y,
                       poses[t].angle_rad + frames * motions[t].angle_rad};
    };
    const SeenAlone begin(cover, after(-0.5 * layers.exposure));
    const SeenAlone end(cover, after(0.5 * layers.exposure));
    const core::PixelRect& window = stack.windows[t];
    for (std::int32_t row = window.y; row < window.y + window.height; ++row) {
      const float* const levels = stack.WindowRow(t, row);
      for (std::int32_t k = 0; k < window.width; ++k) {
        const std::int32_t column = window.x + k;
        if (!begin.At(column, row) || !end.At(column, row)) continue;
        sum += static_cast<double>(levels[k]);
        count += 1.0;
      }
    }
  }
  return count > 0.0 ? sum / count : 0.0;
}

// A body is flat until its pictures say that it is not.
constexpr double kFirstTexture = 0.3;
constexpr int kFlatSteps = 2;  // by then a flat body is told
// By then the step of one shared parameter is within a hundredth: the coarse
// space (coarse_space.h) has told it.
constexpr double kMeasured = 0.05;
constexpr double kMostBlur = 2.0;  // times the first

// What of a picture's noise and texture the residuals show at step `step`.
void Judge(const PictureStack& stack, const FitLayersOptions& options, int step,
           const std::vector<float>& clear, LayerFit& fit,
           std::vector<FrameSamples>& frames) {
  Layers& layers = fit.layers;
  // At first residuals are those of rough poses: as if all were noise.
  constexpr double kAnything = 1e4;  // DN
  layers.noise_dn =
      MeasureNoise(frames, step == 0 ? kAnything : layers.noise_dn);
  if (step == 0) {
    layers.texture.deviation_dn = kFirstTexture * layers.noise_dn;
    Reweigh(layers.noise_dn, frames);
  } else if (layers.flat) {
    const double texture =
        MeasureCommonTexture(stack, layers, fit.poses, frames);
    // So much texture draws outlines by hundredths of a pixel.
    constexpr double kMatters = 0.5;  // of the noise
    if (step >= kFlatSteps && texture > kMatters * layers.noise_dn) {
      LearnTexture(layers);
      layers.texture.deviation_dn = texture;
      LinearizeAll(stack, layers, clear, fit.poses, options, frames);
    }
  } else {
    layers.picture_weight = WeighPicture(layers, frames);
    layers.texture = MeasureTexture(layers, layers.picture_weight);
  }
}

// A step in all unknowns, none farther than the derivatives hold. How far the
// poses moved, px.
double Advance(const JointStep& joint, const FitLayersOptions& options,
               LayerFit& fit) {
  // Farther the model is not linear: the step would be one of another model.
  // Smaller ones take more steps. Not studied.
  constexpr double kMostBlurStep = 0.3;      // px
  constexpr double kMostExposureStep = 0.2;  // of a frame
  constexpr double kMostSizeStep_px = 0.5;
  Layers& layers = fit.layers;
  const double reach = layers.shape.Reach();
  const double most_px = 1.5 * options.prior.value[kBlur];
  double moved = 0.0;
  for (std::size_t t = 0; t < fit.poses.size(); ++t) {
    LayerPose& pose = fit.poses[t];
    const double d_x = Limited(joint.poses[t].x, most_px);
    const double d_y = Limited(joint.poses[t].y, most_px);
    const double turn = Limited(joint.poses[t].angle_rad, most_px / reach);
    pose.x += d_x;
    pose.y += d_y;
    pose.angle_rad += turn;
    moved =
        std::max({moved, std::abs(d_x), std::abs(d_y), std::abs(turn) * reach});
  }
  layers.blur =
      std::clamp(layers.blur + Limited(joint.shared[kBlur], kMostBlurStep), 0.3,
                 kMostBlur * options.prior.value[kBlur]);
  const double exposure = std::sqrt(std::max(
      0.0, layers.exposure * layers.exposure + joint.shared[kExposureSquare]));
  layers.exposure = std::clamp(
      layers.exposure + Limited(exposure - layers.exposure, kMostExposureStep),
      kLeastExposure, 1.0);
  layers.shape.half_long += Limited(joint.shared[kLong], kMostSizeStep_px);
  layers.shape.half_short =
      layers.shape.disc ? layers.shape.half_long
                        : layers.shape.half_short +
                              Limited(joint.shared[kShort], kMostSizeStep_px);
  layers.slope_x += joint.shared[kSlopeX];
  layers.slope_y += joint.shared[kSlopeY];
  for (std::size_t k = 0; k < kTerms && layers.flat; ++k) {
    layers.quadratic[k] += joint.shared[kQuadratic + k];
  }
  for (std::size_t c = 0; c < joint.picture.size(); ++c) {
    layers.picture[c] += joint.picture[c];
  }
  for (std::size_t x = 0; x < layers.still.size(); ++x) {
    layers.still[x] += joint.still[x];
  }
  return moved;
}

JointStepOptions SolveOptions(const FitLayersOptions& options) {
  JointStepOptions solve;
  solve.prior = options.prior;
  solve.turns = options.turns;
  solve.threads = options.threads;
  solve.tolerance = kMeasured;
  return solve;
}

// By how much outlines would lie outside of sizes that are held, from one step
// with sizes that are not: the larger of both sides'.
double MeasureBeyond(const Layers& layers,
                     const std::vector<FrameSamples>& frames,
                     const StillEvidence& evidence, const CoarseSpace& coarse,
                     const FitLayersOptions& options) {
  constexpr double kFree_px = 1.0;  // more than any outline is off
  JointStepOptions solve = SolveOptions(options);
  solve.prior.u[kLong] = kFree_px;
  solve.prior.u[kShort] = kFree_px;
  const JointStep joint =
      SolveJointStep(layers, frames, evidence, coarse, solve);
  return std::max(std::abs(joint.shared[kLong]),
                  std::abs(joint.shared[kShort]));
}

// Steps in all unknowns until the poses no longer move, from step
// `first_step` on.
LayerFit Settle(const PictureStack& stack, int first_step,
                const FitLayersOptions& options, LayerFit fit) {
  Layers& layers = fit.layers;
  std::vector<FrameSamples> frames;
  StillEvidence evidence;
  CoarseSpace coarse;
  JointStepOptions solve = SolveOptions(options);
  // Poses that move by less are found: they are aligned once more each.
  constexpr double kStill_px = 5e-3;
  // Poses that move by more are not where they belong. Of 68 photographed clips
  // none moves so far in its last step; less costs steps where nothing is
  // wrong.
  constexpr double kAstray_px = 0.3;
  double moved_px = std::numeric_limits<double>::infinity();
  const auto most_steps = [&] {
    return options.steps + (moved_px > kAstray_px ? options.steps_astray : 0);
  };
  for (int step = first_step;
       step < first_step + most_steps() && !fit.converged; ++step) {
    options.until.Check();
    LinearizeAll(stack, layers, evidence.weight, fit.poses, options, frames);
    const bool textured = step > 0 && !layers.flat;
    Judge(stack, options, step, evidence.weight, fit, frames);
    solve.tolerance = options.tolerance;
    // A disc's angles hang on its picture alone, which is learned first.
    solve.turns = options.turns && (!layers.shape.disc || step >= kFlatSteps);
    evidence = WeighStill(stack, layers, frames, options.threads);
    if (textured && coarse.empty()) {
      coarse = FindCoarseSpace(layers, frames, evidence, fit.poses, solve);
    }
    moved_px = Advance(SolveJointStep(layers, frames, evidence, coarse, solve),
                       options, fit);
    fit.converged = moved_px < kStill_px && step > kFlatSteps;
  }
  LinearizeAll(stack, layers, evidence.weight, fit.poses, options, frames);
  layers.noise_dn = MeasureNoise(frames, layers.noise_dn);
  if (!layers.flat) {
    layers.picture_weight = WeighPicture(layers, frames);
    layers.texture = MeasureTexture(layers, layers.picture_weight);
  }
  evidence = WeighStill(stack, layers, frames, options.threads);
  layers.still_weight = evidence.weight;
  for (const FrameSamples& samples : frames) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      layers.still_weight[static_cast<std::size_t>(samples.pixel[i])] +=
          samples.weight[i] * samples.open[i] * samples.open[i];
    }
  }
  if (!layers.flat) {
    // The variances are then a few hundredths too small.
    constexpr double kRoughly = 0.2;
    solve.turns = options.turns;
    solve.tolerance = kRoughly;
    fit.common = MeasureCommonUncertainty(layers, frames, evidence, coarse,
                                          fit.poses, solve);
  }
  if (options.textured && options.prior.u[kLong] == 0.0) {
    fit.beyond_px =
        MeasureBeyond(fit.layers, frames, evidence, coarse, options);
  }
  return fit;
}

}  // namespace

void SetOptics(double blur, double exposure, SharedPrior& prior) {
  constexpr double kBlurU_px = 0.5;   // Gauss-Newton finds it from there
  constexpr double kExposureU = 0.3;  // of a frame's interval
  prior.value[kBlur] = blur;
  prior.u[kBlur] = kBlurU_px;
  prior.value[kExposureSquare] = exposure * exposure;
  prior.u[kExposureSquare] = 2.0 * exposure * kExposureU;
}

LayerFit ImproveLayers(const PictureStack& stack, LayerFit fit,
                       const FitLayersOptions& options) {
  fit.converged = false;
  // By then a texture was told, and poses no longer are rough.
  constexpr int kFirstStep = kFlatSteps + 1;
  return Settle(stack, kFirstStep, options, std::move(fit));
}

LayerFit FitLayers(const PictureStack& stack, const Shape& shape,
                   const std::vector<LayerPose>& poses,
                   const std::vector<float>& still, double noise_dn,
                   const FitLayersOptions& options) {
  LayerFit fit;
  fit.poses = poses;
  Layers& layers = fit.layers;
  layers.shape = shape;
  layers.blur = options.prior.value[kBlur];
  layers.exposure = std::clamp(std::sqrt(options.prior.value[kExposureSquare]),
                               kLeastExposure, 1.0);
  layers.still = still;
  layers.noise_dn = noise_dn;
  layers.grid = PictureGrid(shape, kRimBlurs * layers.blur * kMostBlur);
  layers.picture.assign(layers.grid.size(), 0.0F);
  layers.quadratic = {MeanLevel(stack, layers, fit.poses)};
  if (options.textured) LearnTexture(layers);

  return Settle(stack, 0, options, std::move(fit));
}

double MeanLoss(const PictureStack& stack, const LayerFit& fit,
                const Loss& loss) {
  const std::vector<LayerPose> motions =
      EstimateMotions(fit.poses, stack.frames);
  FrameSamples samples;
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t t = 0; t < fit.poses.size(); ++t) {
    Linearize(stack, t, fit.layers, fit.poses[t], motions[t],
              Derivatives::kByPose, samples);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      sum += loss(samples.level[i], samples.level[i] - samples.residual[i]);
    }
    count += samples.size();
  }
  return sum / static_cast<double>(std::max<std::size_t>(count, 1));
}

}  // namespace touchdown::vision::layers
