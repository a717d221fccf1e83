#include "fit_layers.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "touchdown/core/parallel.h"

namespace touchdown::vision::layers {
namespace {

// Blurs of the rim of T's grid: coverage beyond is nothing.
constexpr double kRimBlurs = 3.5;

std::vector<FrameSamples> LinearizeAll(const PictureStack& stack,
                                       const Layers& layers,
                                       const std::vector<LayerPose>& poses,
                                       int threads) {
  const std::vector<LayerPose> motions = MotionsOf(poses, stack.frames);
  std::vector<FrameSamples> frames(poses.size());
  core::InParallel(static_cast<std::int64_t>(poses.size()), threads,
                   [&](std::int64_t begin, std::int64_t end) {
                     for (auto t = static_cast<std::size_t>(begin);
                          t < static_cast<std::size_t>(end); ++t) {
                       frames[t] =
                           Linearize(stack, t, layers, poses[t], motions[t]);
                     }
                   });
  return frames;
}

// Root mean square of the residuals, those beyond four standard deviations
// counted as that.
double NoiseOf(const std::vector<FrameSamples>& frames, double before) {
  constexpr double kCut = 4.0;
  double sum = 0.0;
  double count = 0.0;
  for (const FrameSamples& samples : frames) {
    for (const float residual : samples.residual) {
      const double off = std::min(std::abs(static_cast<double>(residual)),
                                  kCut * before);
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

// The level that most of the body shows.
float MeanLevel(const PictureStack& stack,
                const std::vector<FrameSamples>& frames) {
  constexpr float kWhole = 0.95F;
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const FrameSamples& samples = frames[t];
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (samples.cover[i] < kWhole) continue;
      sum += static_cast<double>(stack.of(t)[samples.pixel[i]]);
      count += 1.0;
    }
  }
  return count > 0.0 ? static_cast<float>(sum / count) : 0.0F;
}

// Standard deviation of what a flat body's residuals have in common, cell by
// cell of its own picture: means over the frames, less the noise of a mean.
double CommonTextureOf(const PictureStack& stack, const Layers& layers,
                       const std::vector<LayerPose>& poses,
                       const std::vector<FrameSamples>& frames) {
  constexpr float kWhole = 0.97F;
  std::vector<double> sums(layers.grid.size());
  std::vector<double> counts(layers.grid.size());
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const FrameSamples& samples = frames[t];
    const double cosine = std::cos(poses[t].angle_rad);
    const double sine = std::sin(poses[t].angle_rad);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (samples.cover[i] < kWhole) continue;
      const double dx = samples.pixel[i] % stack.width - poses[t].x;
      const double dy = samples.pixel[i] / stack.width - poses[t].y;
      const SplinePlace place = layers.grid.PlaceOf(
          static_cast<float>(cosine * dx + sine * dy + 0.5),
          static_cast<float>(cosine * dy - sine * dx + 0.5));
      const auto cell = static_cast<std::size_t>(place.first);
      sums[cell] += static_cast<double>(samples.residual[i]);
      counts[cell] += 1.0;
    }
  }
  constexpr double kEnough = 3.0;
  const double variance = layers.noise_dn * layers.noise_dn;
  double texture2 = 0.0;
  double cells = 0.0;
  for (std::size_t c = 0; c < sums.size(); ++c) {
    if (counts[c] < kEnough) continue;
    const double mean = sums[c] / counts[c];
    texture2 += mean * mean - variance / counts[c];
    cells += 1.0;
  }
  return cells > 0.0 ? std::sqrt(std::max(texture2 / cells, 0.0)) : 0.0;
}

// How often each coefficient of T is seen: the sum of squared coverage.
std::vector<float> WeighPicture(const Layers& layers,
                                const std::vector<FrameSamples>& frames) {
  std::vector<float> weight(layers.grid.size());
  for (const FrameSamples& samples : frames) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const float w = samples.weight[i] * samples.cover[i];
      for (std::size_t k = 0; k < samples.nodes; ++k) {
        const std::size_t at = i * samples.nodes + k;
        layers.grid.Spread(w * samples.share[at], samples.place[at],
                           weight.data());
      }
    }
  }
  return weight;
}

// Empirical Bayes: the variance of T about its own quadratic, over the cells
// inside of the blurred edge, where T is not to be mistaken for the outline's
// place.
double TextureOf(const Layers& layers, const std::vector<float>& weight) {
  constexpr double kBlurs = 1.5;
  constexpr double kLeastHalf = 0.3;  // of a thin body's half side
  using Terms = Eigen::Matrix<double, 6, 1>;
  const Shape& shape = layers.shape;
  const auto inner = [&](double half) {
    return std::max(half - kBlurs * layers.blur, kLeastHalf * half);
  };
  const double half_x = inner(shape.half_long);
  const double half_y = inner(shape.half_short);
  std::vector<std::pair<std::size_t, Terms>> inside;
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  Terms right = Terms::Zero();
  for (std::size_t c = 0; c < weight.size(); ++c) {
    const auto cell = static_cast<std::int32_t>(c);
    const double x =
        static_cast<double>(layers.grid.x_of(cell % layers.grid.columns())) /
        half_x;
    const double y =
        static_cast<double>(layers.grid.y_of(cell / layers.grid.columns())) /
        half_y;
    const bool is_inside =
        shape.disc ? std::hypot(x, y) <= 1.0
                   : std::abs(x) <= 1.0 && std::abs(y) <= 1.0;
    if (!is_inside) continue;
    Terms terms;
    terms << 1.0, x, y, x * x, x * y, y * y;
    normal += terms * terms.transpose();
    right += static_cast<double>(layers.picture[c]) * terms;
    inside.emplace_back(c, terms);
  }
  constexpr std::size_t kLeastCells = 12;
  if (inside.size() < kLeastCells) return layers.texture_dn;
  normal.diagonal().array() += 1e-6;
  const Terms quadratic = normal.ldlt().solve(right);
  const double variance = layers.noise_dn * layers.noise_dn;
  const double texture2 = layers.texture_dn * layers.texture_dn;
  double sum = 0.0;
  for (const auto& [c, terms] : inside) {
    const double off =
        static_cast<double>(layers.picture[c]) - quadratic.dot(terms);
    // The posterior's own variance is added: expectation maximisation.
    sum += off * off + 1.0 / (static_cast<double>(weight[c]) / variance +
                              1.0 / std::max(texture2, 1e-12));
  }
  return std::sqrt(sum / static_cast<double>(inside.size()));
}

double Clamp(double value, double most) {
  return std::clamp(value, -most, most);
}

}  // namespace

LayerFit FitLayers(const PictureStack& stack, const Shape& shape,
                   const std::vector<LayerPose>& poses,
                   const std::vector<float>& still, double noise_dn,
                   const FitLayersOptions& options) {
  LayerFit fit;
  fit.poses = poses;
  Layers& layers = fit.layers;
  layers.shape = shape;
  layers.blur = options.prior.value[kBlur];
  layers.exposure = options.prior.value[kExposure];
  layers.still = still;
  layers.noise_dn = noise_dn;
  // A body is flat until its pictures say that it is not.
  constexpr double kFirstTexture = 0.3;
  constexpr double kAnything = 1e4;  // DN
  constexpr int kFlatSteps = 2;      // by then a flat body is told
  constexpr double kRough = 0.05;
  constexpr double kFine = 5e-3;
  constexpr double kMostBlur = 2.0;  // times the first
  layers.grid =
      PictureGrid(shape, kRimBlurs * layers.blur * kMostBlur);
  layers.picture.assign(layers.grid.size(), 0.0F);
  const FreePart free(layers.grid);
  std::vector<FrameSamples> frames =
      LinearizeAll(stack, layers, fit.poses, options.threads);
  layers.quadratic = {static_cast<double>(MeanLevel(stack, frames))};
  if (options.textured) LearnTexture(layers);

  JointStepOptions solve;
  solve.prior = options.prior;
  solve.turns = options.turns;
  solve.threads = options.threads;
  // A step goes no farther: beyond, the derivatives say nothing.
  const double most_px = 1.5 * layers.blur;
  const double most_rad = most_px / shape.Reach();
  constexpr double kMostBlurStep = 0.3;
  constexpr double kMostExposureStep = 0.2;
  constexpr double kMostSizeStep_px = 0.5;
  // Poses that move by less are found: they are aligned once more each.
  constexpr double kStill_px = 5e-3;
  for (int step = 0; step < options.steps; ++step) {
    frames = LinearizeAll(stack, layers, fit.poses, options.threads);
    // At first residuals are those of rough poses: as if all were noise.
    layers.noise_dn =
        NoiseOf(frames, step == 0 ? kAnything : layers.noise_dn);
    if (step == 0) {
      layers.texture_dn = kFirstTexture * layers.noise_dn;
      Reweigh(layers.noise_dn, frames);
    } else if (layers.flat) {
      const double texture =
          CommonTextureOf(stack, layers, fit.poses, frames);
      // So much texture draws outlines by hundredths of a pixel.
      constexpr double kMatters = 0.5;  // of the noise
      if (step >= kFlatSteps && texture > kMatters * layers.noise_dn) {
        LearnTexture(layers);
        layers.texture_dn = texture;
        frames = LinearizeAll(stack, layers, fit.poses, options.threads);
      }
    } else {
      layers.picture_weight = WeighPicture(layers, frames);
      layers.texture_dn = TextureOf(layers, layers.picture_weight);
    }
    // First steps are not worth more.
    solve.tolerance = step < kFlatSteps ? kRough : kFine;
    const StillEvidence evidence =
        WeighStill(stack, layers, frames, options.threads);
    const JointStep joint =
        SolveJointStep(layers, frames, evidence, free, solve);
    double moved = 0.0;
    for (std::size_t t = 0; t < fit.poses.size(); ++t) {
      LayerPose& pose = fit.poses[t];
      const double d_x = Clamp(joint.poses[t].x, most_px);
      const double d_y = Clamp(joint.poses[t].y, most_px);
      const double turn = Clamp(joint.poses[t].angle_rad, most_rad);
      pose.x += d_x;
      pose.y += d_y;
      pose.angle_rad += turn;
      moved = std::max({moved, std::abs(d_x), std::abs(d_y),
                        std::abs(turn) * shape.Reach()});
    }
    layers.blur = std::clamp(
        layers.blur + Clamp(joint.shared[kBlur], kMostBlurStep), 0.3,
        kMostBlur * options.prior.value[kBlur]);
    layers.exposure = std::clamp(
        layers.exposure + Clamp(joint.shared[kExposure], kMostExposureStep),
        0.0, 1.0);
    layers.shape.half_long += Clamp(joint.shared[kLong], kMostSizeStep_px);
    layers.shape.half_short =
        shape.disc ? layers.shape.half_long
                   : layers.shape.half_short +
                         Clamp(joint.shared[kShort], kMostSizeStep_px);
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
    if (getenv("LAYDBG")) fprintf(stderr, "flat %d step %d moved %.4f noise %.3f tex %.3f blur %.3f exp %.3f size %.3f %.3f slope %.2f %.2f products %d\n", layers.flat, step, moved, layers.noise_dn, layers.texture_dn, layers.blur, layers.exposure, layers.shape.half_long, layers.shape.half_short, layers.slope_x, layers.slope_y, joint.products);
    if (moved < kStill_px && step > kFlatSteps) {
      fit.converged = true;
      break;
    }
  }
  frames = LinearizeAll(stack, layers, fit.poses, options.threads);
  layers.noise_dn = NoiseOf(frames, layers.noise_dn);
  if (!layers.flat) {
    layers.picture_weight = WeighPicture(layers, frames);
    layers.texture_dn = TextureOf(layers, layers.picture_weight);
  }
  const StillEvidence evidence =
      WeighStill(stack, layers, frames, options.threads);
  layers.still_weight = evidence.weight;
  double sum = 0.0;
  double count = 0.0;
  for (const FrameSamples& samples : frames) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      layers.still_weight[static_cast<std::size_t>(samples.pixel[i])] +=
          samples.weight[i] * samples.open[i] * samples.open[i];
      sum += static_cast<double>(samples.residual[i]) *
             static_cast<double>(samples.residual[i]);
      count += 1.0;
    }
  }
  fit.chi2 = count > 0.0 ? sum / count : 0.0;
  return fit;
}

namespace {

// 1 over the variance of a pixel in units of noise^2: its own and what B and T
// are not known to.
void WeighByLayers(const Layers& layers, FrameSamples& samples) {
  constexpr float kLeastStill = 0.3F;  // below, B was never seen
  constexpr float kWhole = 0.95F;
  const double texture2 = layers.texture_dn * layers.texture_dn;
  const float prior = static_cast<float>(
      layers.noise_dn * layers.noise_dn / std::max(texture2, 1e-12));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const float seen =
        layers.still_weight[static_cast<std::size_t>(samples.pixel[i])];
    const float open = samples.open[i];
    const float cover = samples.cover[i];
    if (seen < kLeastStill && cover < kWhole) {
      samples.weight[i] = 0.0F;
      continue;
    }
    float unknown = open * open / std::max(seen, kLeastStill);
    if (!layers.flat) {
      const float picture = layers.grid.ValueAt(
          layers.picture_weight.data(),
          samples.place[i * samples.nodes + samples.nodes / 2]);
      unknown += cover * cover / (std::max(picture, 0.0F) + prior);
    }
    samples.weight[i] /= 1.0F + unknown;
  }
}

using Matrix = Eigen::Matrix3d;

// Sum over pairs of pixels: c(lag) g(x) g(x + lag)', g = w J.
Matrix SandwichOf(const FrameSamples& samples, std::int32_t width,
                  double variance) {
  constexpr std::int32_t kLags = 4;  // px
  // The samples on a grid of their own.
  std::int32_t left = width;
  std::int32_t right = 0;
  std::int32_t top = samples.pixel.front() / width;
  std::int32_t bottom = samples.pixel.back() / width;
  for (const std::int32_t pixel : samples.pixel) {
    left = std::min(left, pixel % width);
    right = std::max(right, pixel % width);
  }
  const std::int32_t columns = right - left + 1;
  const std::int32_t rows = bottom - top + 1;
  const auto cells = static_cast<std::size_t>(columns) *
                     static_cast<std::size_t>(rows);
  std::array<std::vector<float>, kPose> g;
  for (auto& column : g) column.assign(cells, 0.0F);
  std::vector<float> residual(cells, 0.0F);
  std::vector<float> known(cells, 0.0F);
  const auto cut = static_cast<float>(5.0 * std::sqrt(variance));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto at = static_cast<std::size_t>(
        (samples.pixel[i] / width - top) * columns + samples.pixel[i] % width -
        left);
    for (std::size_t a = 0; a < kPose; ++a) {
      g[a][at] = samples.weight[i] * samples.by_pose[a][i];
    }
    if (samples.weight[i] > 0.1F) {
      residual[at] = std::clamp(samples.residual[i], -cut, cut);
      known[at] = 1.0F;
    }
  }
  Matrix sum = Matrix::Zero();
  for (std::int32_t down = 0; down <= kLags; ++down) {
    for (std::int32_t across = down == 0 ? 0 : -kLags; across <= kLags;
         ++across) {
      double products = 0.0;
      double pairs = 0.0;
      Matrix own = Matrix::Zero();
      for (std::int32_t y = 0; y + down < rows; ++y) {
        const std::int32_t from = std::max(0, -across);
        const std::int32_t to = std::min(columns, columns - across);
        if (to <= from) continue;
        const auto row = static_cast<std::size_t>(y * columns);
        const auto other = static_cast<std::size_t>((y + down) * columns + across);
        float product = 0.0F;
        float pair = 0.0F;
        std::array<float, 9> g_g{};
        for (auto x = static_cast<std::size_t>(from);
             x < static_cast<std::size_t>(to); ++x) {
          product += residual[row + x] * residual[other + x];
          pair += known[row + x] * known[other + x];
          for (std::size_t a = 0; a < kPose; ++a) {
            for (std::size_t b = 0; b < kPose; ++b) {
              g_g[kPose * a + b] += g[a][row + x] * g[b][other + x];
            }
          }
        }
        products += static_cast<double>(product);
        pairs += static_cast<double>(pair);
        for (std::size_t a = 0; a < kPose; ++a) {
          for (std::size_t b = 0; b < kPose; ++b) {
            own(static_cast<int>(a), static_cast<int>(b)) +=
                static_cast<double>(g_g[kPose * a + b]);
          }
        }
      }
      if (pairs < 1.0) continue;
      const double away = std::hypot(static_cast<double>(across),
                                     static_cast<double>(down));
      const double taper = std::max(0.0, 1.0 - away / (kLags + 1));  // Bartlett
      double correlation = taper * products / pairs;
      if (down == 0 && across == 0) {
        sum += std::max(correlation, variance) * own;
      } else {
        sum += correlation * (own + own.transpose());
      }
    }
  }
  return sum;
}

}  // namespace

PoseFit AlignPose(const PictureStack& stack, std::size_t picture,
                  const Layers& layers, const LayerPose& start,
                  const LayerPose& motion, bool turns) {
  constexpr int kSteps = 5;
  constexpr double kStill_px = 2e-3;
  constexpr std::size_t kLeastPixels = 12;
  PoseFit out;
  out.pose = start;
  const double reach = layers.shape.Reach();
  const double most_px = 1.5 * layers.blur;
  Matrix normal = Matrix::Identity();
  FrameSamples samples;
  for (int step = 0; step < kSteps; ++step) {
    samples = Linearize(stack, picture, layers, out.pose, motion);
    if (samples.size() < kLeastPixels) return out;
    WeighByLayers(layers, samples);
    normal.setZero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Eigen::Vector3d j(static_cast<double>(samples.by_pose[0][i]),
                              static_cast<double>(samples.by_pose[1][i]),
                              static_cast<double>(samples.by_pose[2][i]));
      const auto w = static_cast<double>(samples.weight[i]);
      normal += w * j * j.transpose();
      right += w * static_cast<double>(samples.residual[i]) * j;
    }
    if (!turns) {
      normal.row(2).setZero();
      normal.col(2).setZero();
      normal(2, 2) = 1.0;
      right(2) = 0.0;
    }
    if (!(std::abs(normal.determinant()) > 0.0)) return out;
    const Eigen::Vector3d by = normal.ldlt().solve(right);
    if (!by.allFinite()) return out;
    out.pose.x += Clamp(by(0), most_px);
    out.pose.y += Clamp(by(1), most_px);
    out.pose.angle_rad += Clamp(by(2), most_px / reach);
    if (std::max({std::abs(by(0)), std::abs(by(1)),
                  std::abs(by(2)) * reach}) < kStill_px) {
      break;
    }
  }
  const double variance = layers.noise_dn * layers.noise_dn;
  Matrix sandwich = SandwichOf(samples, stack.width, variance);
  if (!turns) {
    sandwich.row(2).setZero();
    sandwich.col(2).setZero();
  }
  const Matrix inverse = normal.inverse();
  const Matrix covariance = inverse * sandwich * inverse;
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples.weight[i] <= 0.0F) continue;
    sum += static_cast<double>(samples.residual[i]) *
           static_cast<double>(samples.residual[i]);
    count += 1.0;
  }
  out.chi2 = sum / std::max(count, 1.0) / variance;
  for (std::size_t a = 0; a < 2; ++a) {
    double second = 0.0;
    double fourth = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const auto j = static_cast<double>(samples.by_pose[a][i]);
      const double square = j * j * static_cast<double>(samples.weight[i]);
      second += square;
      fourth += square * j * j;
    }
    out.steepness[a] = second > 0.0 ? std::sqrt(fourth / second) : 0.0;
  }
  out.widened = std::sqrt((covariance(0, 0) + covariance(1, 1)) /
                          (variance * (inverse(0, 0) + inverse(1, 1))));
  double covered = 0.0;
  for (const float cover : samples.cover) {
    covered += static_cast<double>(cover);
  }
  out.seen = covered / layers.shape.Area();
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      out.covariance[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] =
          covariance(a, b);
    }
  }
  // A covariance of white noise at the least.
  for (std::size_t a = 0; a < kPose; ++a) {
    const double least = variance * inverse(static_cast<int>(a), static_cast<int>(a));
    out.covariance[a][a] = std::max(out.covariance[a][a], turns || a < 2 ? least : 0.0);
  }
  out.found = true;
  return out;
}

}  // namespace touchdown::vision::layers
