#include "layers/align_pose.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "layers/columns.h"
#include "touchdown/core/parallel.h"

namespace touchdown::vision::layers {
namespace {

// 1 over the variance of a pixel in units of noise^2: its own and what B and T
// are not known to. An error of B is the same in all frames in which the
// outline lies on the pixel, and does not average out over them: it counts so
// many times.
void WeighByLayers(const Layers& layers, const LayerPose& motion,
                   FrameSamples& samples) {
  constexpr float kLeastStill = 0.3F;  // below, B was never seen
  // Share from which on the body alone is seen, and B need not be known.
  constexpr float kWhole = 0.95F;
  // Frames that an error of B can be shared by: of a body that stands still, no
  // more. Larger widens slow bodies without end. Not studied.
  constexpr float kMostFrames = 40.0F;
  const auto edge = static_cast<float>(4.0 * layers.blur);  // its width, px
  const auto v_x = static_cast<float>(motion.x);
  const auto v_y = static_cast<float>(motion.y);
  const double texture2 =
      layers.texture.deviation_dn * layers.texture.deviation_dn;
  const auto prior = static_cast<float>(layers.noise_dn * layers.noise_dn /
                                        std::max(texture2, 1e-12));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const float seen =
        layers.still_weight[static_cast<std::size_t>(samples.pixel[i])];
    const float open = samples.open[i];
    const float cover = samples.cover[i];
    if (seen < kLeastStill && cover < kWhole) {
      samples.weight[i] = 0.0F;
      continue;
    }
    const float g_x = samples.by_pose[0][i];
    const float g_y = samples.by_pose[1][i];
    const float steep = std::sqrt(g_x * g_x + g_y * g_y);
    const float pace = std::abs(g_x * v_x + g_y * v_y);
    const float frames =
        std::clamp(edge * steep / std::max(pace, 1e-6F), 1.0F, kMostFrames);
    float unknown = open * open * frames / std::max(seen, kLeastStill);
    if (!layers.flat) {
      const float picture = layers.grid.EvaluateSpline(
          layers.picture_weight.data(),
          samples.place[i * samples.nodes + samples.nodes / 2]);
      unknown += cover * cover / (std::max(picture, 0.0F) + prior);
    }
    samples.weight[i] /= 1.0F + unknown;
  }
}

using PoseMatrix = Eigen::Matrix3d;

// Sum over pairs of pixels: c(lag) g(x) g(x + lag)', g = w J, of the first
// `free` coordinates of a pose.
PoseMatrix ComputeSandwich(const FrameSamples& samples, std::int32_t width,
                           double variance, int free) {
  constexpr std::int32_t kLags = 4;  // px
  // The samples on a grid of their own, with so many zeros beside and below it
  // that a shifted grid ends in them.
  std::int32_t left = width;
  std::int32_t right = 0;
  const std::int32_t top = samples.pixel.front() / width;
  const std::int32_t bottom = samples.pixel.back() / width;
  for (const std::int32_t pixel : samples.pixel) {
    left = std::min(left, pixel % width);
    right = std::max(right, pixel % width);
  }
  const auto stride =
      (static_cast<std::size_t>(right - left + 1 + kLags) / kSumPlaces + 1) *
      kSumPlaces;
  const std::size_t cells = stride * static_cast<std::size_t>(bottom - top + 1);
  const std::vector<float> zeros(cells + (kLags + 1) * stride, 0.0F);
  std::array<std::vector<float>, kPose> g;
  for (auto& column : g) column = zeros;
  std::vector<float> residual = zeros;
  std::vector<float> known = zeros;
  const auto cut = static_cast<float>(5.0 * std::sqrt(variance));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto at =
        static_cast<std::size_t>(samples.pixel[i] / width - top) * stride +
        static_cast<std::size_t>(samples.pixel[i] % width - left);
    for (std::size_t a = 0; a < kPose; ++a) {
      g[a][at] = samples.weight[i] * samples.by_pose[a][i];
    }
    if (samples.weight[i] > 0.1F) {
      residual[at] = std::clamp(samples.residual[i], -cut, cut);
      known[at] = 1.0F;
    }
  }
  PoseMatrix sum = PoseMatrix::Zero();
  for (std::int32_t down = 0; down <= kLags; ++down) {
    for (std::int32_t across = down == 0 ? 0 : -kLags; across <= kLags;
         ++across) {
      const std::ptrdiff_t lag =
          down * static_cast<std::ptrdiff_t>(stride) + across;
      std::array<double, kMostColumns> sums{};
      const auto overlap = [&](const std::vector<float>& a,
                               const std::vector<float>& b) {
        SumProducts({a.data()}, 1, b.data() + lag, cells, sums);
        return sums.front();
      };
      const double away =
          std::hypot(static_cast<double>(across), static_cast<double>(down));
      const double taper = 1.0 - away / (kLags + 1);  // Bartlett
      if (!(taper > 0.0)) continue;
      const double pairs = overlap(known, known);
      if (pairs < 1.0) continue;
      PoseMatrix own = PoseMatrix::Zero();
      for (int b = 0; b < free; ++b) {
        SumProducts({g[0].data(), g[1].data(), g[2].data()},
                    static_cast<std::size_t>(free),
                    g[static_cast<std::size_t>(b)].data() + lag, cells, sums);
        for (int a = 0; a < free; ++a) {
          own(a, b) = sums[static_cast<std::size_t>(a)];
        }
      }
      const double correlation = taper * overlap(residual, residual) / pairs;
      if (lag == 0) {
        sum += std::max(correlation, variance) * own;
      } else {
        sum += correlation * (own + own.transpose());
      }
    }
  }
  return sum;
}

// J' W J and J' W r of a pose. `weighted` is room for a column.
void AddUpNormal(const FrameSamples& samples, std::vector<float>& weighted,
                 PoseMatrix& normal, Eigen::Vector3d& right) {
  const ColumnList columns = {
      samples.by_pose[0].data(), samples.by_pose[1].data(),
      samples.by_pose[2].data(), samples.residual.data()};
  std::array<double, kMostColumns> sums{};
  weighted.resize(samples.size());
  for (std::size_t a = 0; a < kPose; ++a) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      weighted[i] = samples.weight[i] * samples.by_pose[a][i];
    }
    SumProducts(columns, kPose + 1, weighted.data(), samples.size(), sums);
    const auto row = static_cast<int>(a);
    for (int b = 0; b < 3; ++b) {
      normal(row, b) = sums[static_cast<std::size_t>(b)];
    }
    right(row) = sums[kPose];
  }
}

// Of Gauss and Newton, from `start` on: the pose, how well it explains its
// pixels, these pixels and the normal matrix there.
struct Alignment {
  LayerPose pose;
  double chi2 = 0.0;
  PoseMatrix normal = PoseMatrix::Identity();
  FrameSamples samples;
  bool found = false;
};

// The step after which no other is taken: small beside a pose's u, which is
// some hundredths of a pixel; and where the pose is aligned once more.
constexpr double kStill_px = 2e-3;
constexpr double kNearlyStill_px = 2e-2;

// Nothing is found where the steps come near to `known`: it is the same again.
Alignment FindPose(const PictureStack& stack, std::size_t picture,
                   const Layers& layers, const LayerPose& start,
                   const LayerPose& motion, bool turns, double still_px,
                   const LayerPose* known = nullptr) {
  // A bound on time, mostly not reached. Not studied.
  constexpr int kSteps = 5;
  // From there a step ends at the same minimum. Not studied.
  constexpr double kSame_px = 0.3;
  // Fewer do not tell three numbers and how far they scatter. Not studied.
  constexpr std::size_t kLeastPixels = 12;
  Alignment out;
  out.pose = start;
  const double reach = layers.shape.Reach();
  const double most_px = 1.5 * layers.blur;
  PoseMatrix& normal = out.normal;
  FrameSamples& samples = out.samples;
  std::vector<float> weighted;
  for (int step = 0; step < kSteps; ++step) {
    Linearize(stack, picture, layers, out.pose, motion, Derivatives::kByPose,
              samples);
    if (samples.size() < kLeastPixels) return out;
    WeighByLayers(layers, motion, samples);
    Eigen::Vector3d right;
    AddUpNormal(samples, weighted, normal, right);
    if (!turns) {
      normal.row(2).setZero();
      normal.col(2).setZero();
      normal(2, 2) = 1.0;
      right(2) = 0.0;
    }
    if (!(std::abs(normal.determinant()) > 0.0)) return out;
    const Eigen::Vector3d by = normal.ldlt().solve(right);
    if (!by.allFinite()) return out;
    out.pose.x += Limited(by(0), most_px);
    out.pose.y += Limited(by(1), most_px);
    out.pose.angle_rad += Limited(by(2), most_px / reach);
    if (std::max({std::abs(by(0)), std::abs(by(1)), std::abs(by(2)) * reach}) <
        still_px) {
      break;
    }
    if (known != nullptr &&
        std::max({std::abs(out.pose.x - known->x),
                  std::abs(out.pose.y - known->y),
                  std::abs(out.pose.angle_rad - known->angle_rad) * reach}) <
            kSame_px) {
      return out;
    }
  }
  const double variance = layers.noise_dn * layers.noise_dn;
  constexpr double kMostSquare = 16.0;  // of the noise: four deviations
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples.weight[i] <= 0.0F) continue;
    const auto residual = static_cast<double>(samples.residual[i]);
    sum += std::min(residual * residual, kMostSquare * variance);
    count += 1.0;
  }
  out.chi2 = sum / std::max(count, 1.0) / variance;
  out.found = true;
  return out;
}

}  // namespace

PoseFit AlignPose(const PictureStack& stack, std::size_t picture,
                  const Layers& layers, const LayerPose& start,
                  const LayerPose& motion, bool turns) {
  const Alignment at =
      FindPose(stack, picture, layers, start, motion, turns, kStill_px);
  PoseFit out;
  out.pose = at.pose;
  if (!at.found) return out;
  const FrameSamples& samples = at.samples;
  out.chi2 = at.chi2;
  const double variance = layers.noise_dn * layers.noise_dn;
  const PoseMatrix sandwich =
      ComputeSandwich(samples, stack.width, variance, turns ? 3 : 2);
  const PoseMatrix inverse = at.normal.inverse();
  const PoseMatrix covariance = inverse * sandwich * inverse;
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
  double changed = 0.0;
  double left = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto cover = static_cast<double>(samples.cover[i]);
    const auto change = static_cast<double>(
        samples.level[i] -
        layers.still[static_cast<std::size_t>(samples.pixel[i])]);
    const auto residual = static_cast<double>(samples.residual[i]);
    covered += cover;
    changed += cover * change * change;
    left += cover * residual * residual;
  }
  out.seen = covered / layers.shape.Area();
  if (changed > 0.0) out.explained = 1.0 - left / changed;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      out.covariance[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] =
          covariance(a, b);
    }
  }
  // A covariance of white noise at the least.
  for (std::size_t a = 0; a < kPose; ++a) {
    const double least =
        variance * inverse(static_cast<int>(a), static_cast<int>(a));
    out.covariance[a][a] =
        std::max(out.covariance[a][a], turns || a < 2 ? least : 0.0);
  }
  out.found = true;
  return out;
}

std::size_t AlignPoses(const PictureStack& stack, const Layers& layers,
                       bool turns, int threads, std::vector<LayerPose>& poses) {
  constexpr double kWorse = 1.25;   // of the median chi^2: clearly worse
  constexpr double kBetter = 0.85;  // of the chi^2 before: no noise does that
  // As far around as a step reaches from both sides.
  const double reach = std::max(1.0, 2.0 * layers.blur);  // px
  const std::vector<LayerPose> motions = EstimateMotions(poses, stack.frames);
  std::vector<double> chi2(poses.size());
  std::vector<LayerPose> better = poses;
  const auto each = [&](const auto& align) {
    core::InParallel(static_cast<std::int64_t>(poses.size()), threads,
                     [&](std::int64_t begin, std::int64_t end) {
                       for (auto t = static_cast<std::size_t>(begin);
                            t < static_cast<std::size_t>(end); ++t) {
                         align(t);
                       }
                     });
  };
  each([&](std::size_t t) {
    const Alignment fit = FindPose(stack, t, layers, poses[t], motions[t],
                                   turns, kNearlyStill_px);
    chi2[t] = fit.chi2;
    if (fit.found) better[t] = fit.pose;
  });
  std::vector<double> sorted = chi2;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2,
                   sorted.end());
  const double usual = sorted[sorted.size() / 2];
  std::vector<char> moved(poses.size(), 0);
  each([&](std::size_t t) {
    if (chi2[t] < kWorse * usual) return;
    double least = kBetter * chi2[t];
    for (int down = -1; down <= 1; ++down) {
      for (int across = -1; across <= 1; ++across) {
        if (down == 0 && across == 0) continue;
        LayerPose start = poses[t];
        start.x += across * reach;
        start.y += down * reach;
        const Alignment fit = FindPose(stack, t, layers, start, motions[t],
                                       turns, kNearlyStill_px, &better[t]);
        if (!fit.found || fit.chi2 >= least) continue;
        least = fit.chi2;
        better[t] = fit.pose;
        moved[t] = 1;
      }
    }
  });
  poses = std::move(better);
  return static_cast<std::size_t>(std::count(moved.begin(), moved.end(), 1));
}

}  // namespace touchdown::vision::layers
