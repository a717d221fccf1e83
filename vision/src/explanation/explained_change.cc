#include "touchdown/vision/explanation/explained_change.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numeric>
#include <stdexcept>

#include "explanation/change_samples.h"
#include "explanation/seen_area.h"
#include "explanation/two_layers.h"
#include "numbers/robust.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/footage/linear_clip.h"

namespace touchdown::vision {
namespace {

// With fewer frames or points no variance is known.
void CheckArguments(const Clip& clip, const Track& track,
                    const ExplainedChangeOptions& options) {
  const auto check = [](const char* field, int value, int least) {
    if (value >= least) return;
    throw std::invalid_argument(
        fmt::format("{} is {}, must be at least {}", field, value, least));
  };
  check("frames", options.frames, 3);
  check("points_near", options.points_near, 100);
  check("points_elsewhere", options.points_elsewhere, 100);
  if (track.first_frame < 0 || track.last_frame > clip.info().frames) {
    throw std::invalid_argument(
        fmt::format("track is of frames {}:{}, must be within 0:{}",
                    track.first_frame, track.last_frame, clip.info().frames));
  }
}

// Of each point, over the frames.
struct OverTime {
  std::vector<float> mean;
  std::vector<float> median;
  std::vector<float> square;  // sum of (I - mean)^2
};

OverTime SumOverTime(const LatticeLevels& levels, std::size_t frames,
                     std::size_t points) {
  OverTime over;
  over.mean.assign(points, 0.0F);
  over.square.assign(points, 0.0F);
  for (std::size_t k = 0; k < frames; ++k) {
    const float* level = levels.of(k);
    for (std::size_t p = 0; p < points; ++p) over.mean[p] += level[p];
  }
  for (float& mean : over.mean) mean /= static_cast<float>(frames);
  for (std::size_t k = 0; k < frames; ++k) {
    const float* level = levels.of(k);
    for (std::size_t p = 0; p < points; ++p) {
      const float off = level[p] - over.mean[p];
      over.square[p] += off * off;
    }
  }
  over.median.resize(points);
  std::vector<float> of_point(frames);
  for (std::size_t p = 0; p < points; ++p) {
    for (std::size_t k = 0; k < frames; ++k) of_point[k] = levels.of(k)[p];
    over.median[p] = MedianInPlace(of_point);
  }
  return over;
}

// Variance of a pixel over time where nothing moves, by its level: photons
// count more in the light, and a camera's gamma raises noise in the dark. Of
// points of like level it is the median, divided by that of chi^2 with n - 1
// degrees of freedom, (n - 1) (1 - 2 / (9 (n - 1)))^3 (Wilson and Hilferty
// 1931). A point's level is its median over time: what passes does not change
// it.
class LevelNoise {
 public:
  // From the points far from the body's path, where there are enough of them
  // (near it most pixels are crossed by the body).
  LevelNoise(const OverTime& near, const OverTime& elsewhere,
             std::size_t frames) {
    // Points of like level: their median is then known to about 2 %. Not
    // studied.
    constexpr std::size_t kPoints = 200;
    const OverTime& over =
        elsewhere.square.size() >= kPoints ? elsewhere : near;
    const std::size_t points = over.square.size();
    std::vector<std::size_t> by_level(points);
    std::iota(by_level.begin(), by_level.end(), std::size_t{0});
    std::sort(by_level.begin(), by_level.end(),
              [&](std::size_t a, std::size_t b) {
                return over.median[a] < over.median[b];
              });
    const double freedom = static_cast<double>(frames) - 1.0;
    const double of_median =
        freedom * std::pow(1.0 - 2.0 / (9.0 * freedom), 3.0);
    const auto estimate = [&](std::size_t from, std::size_t to) {
      std::vector<float> squares;
      for (std::size_t i = from; i < to; ++i) {
        squares.push_back(over.square[by_level[i]]);
      }
      return std::max(static_cast<double>(MedianInPlace(squares)) / of_median,
                      Background::kVarianceFloor_dn2);
    };
    const std::size_t groups = std::max<std::size_t>(1, points / kPoints);
    for (std::size_t g = 0; g < groups; ++g) {
      const std::size_t from = g * points / groups;
      const std::size_t to = (g + 1) * points / groups;
      up_to_.push_back(over.median[by_level[to - 1]]);
      variance_.push_back(estimate(from, to));
    }
    usual_ = estimate(0, points);
  }

  double At(float level) const {
    const auto group = std::lower_bound(up_to_.begin(), up_to_.end(), level);
    return variance_[std::min(static_cast<std::size_t>(group - up_to_.begin()),
                              variance_.size() - 1)];
  }
  double usual() const { return usual_; }

 private:
  std::vector<float> up_to_;  // the highest level of each group
  std::vector<double> variance_;
  double usual_ = 0.0;
};

// Sum of the change beyond noise, over the points whose own variance stands out
// of it.
double ChangeBeyondNoise(const OverTime& over, const LevelNoise& noise,
                         std::size_t frames) {
  const double freedom = static_cast<double>(frames) - 1.0;
  // Meant to leave out noise of compression and of light that is not quite
  // steady: three times the usual standard deviation (9 in variance), plus six
  // standard deviations of the estimate itself. Larger misses faint things that
  // move; smaller counts noise. Chosen, not measured yet.
  constexpr double kNoiseFactor = 9.0;
  constexpr double kEstimateSigmas = 6.0;
  const double least =
      kNoiseFactor * freedom + kEstimateSigmas * std::sqrt(2.0 * freedom);
  double sum = 0.0;
  for (std::size_t p = 0; p < over.square.size(); ++p) {
    const double variance = noise.At(over.median[p]);
    const auto square = static_cast<double>(over.square[p]);
    if (square > variance * least) sum += square - variance * freedom;
  }
  return sum;
}

// Sums of squared residuals, DN^2.
struct Residuals {
  double square = 0.0;       // near
  double band_square = 0.0;  // where the edge is
  std::int64_t band = 0;
};

// Adds the residuals of a frame with a pose: the two-layer model where it is
// known, the mean over time elsewhere.
void AddResiduals(const TwoLayers& layers, const CoveredPoints& covered,
                  const OverTime& over, const float* level,
                  std::vector<float>& residual, Residuals& sums) {
  // Coverage between which a pixel belongs to the edge's band. Not studied.
  constexpr float kBandFrom = 0.02F;
  constexpr float kBandTo = 0.98F;
  for (std::size_t p = 0; p < residual.size(); ++p) {
    residual[p] =
        level[p] - (layers.is_known(p) ? layers.still(p) : over.mean[p]);
  }
  for (std::size_t i = 0; i < covered.point.size(); ++i) {
    const auto p = static_cast<std::size_t>(covered.point[i]);
    const float m = covered.cover[i];
    if (!layers.is_known(p) && m < kWhollyCovered) continue;
    const float behind = layers.is_known(p) ? layers.still(p) : 0.0F;
    residual[p] =
        level[p] - (1.0F - m) * behind - m * layers.picture(covered, i);
    if (m > kBandFrom && m < kBandTo) {
      sums.band_square += static_cast<double>(residual[p]) * residual[p];
      ++sums.band;
    }
  }
  for (const float r : residual) {
    sums.square += static_cast<double>(r) * static_cast<double>(r);
  }
}

// Adds a frame without a pose: its deviation from the mean over time or from
// the still layer, whichever is less.
void AddUnexplained(const TwoLayers& layers, const OverTime& over,
                    const float* level, Residuals& sums) {
  double from_mean = 0.0;
  double from_still = 0.0;
  for (std::size_t p = 0; p < over.mean.size(); ++p) {
    const double off = level[p] - over.mean[p];
    from_mean += off * off;
    const double other = layers.is_known(p) ? level[p] - layers.still(p) : off;
    from_still += other * other;
  }
  sums.square += std::min(from_mean, from_still);
}

// The two layers of a track, over the samples near its path.
struct Rendered {
  Rendered(const Track& track, const std::vector<SampledFrame>& frames,
           const LatticePoints& near, const LatticeLevels& levels, int threads)
      : covered(CoverPoints(track, frames, near, threads)),
        layers(track, frames, near, levels, covered) {}

  std::vector<CoveredPoints> covered;  // of each frame
  TwoLayers layers;
};

// What they leave of all samples.
Residuals SumResiduals(const Rendered& rendered,
                       const std::vector<SampledFrame>& frames,
                       const LatticeLevels& levels, const OverTime& over) {
  Residuals sums;
  std::vector<float> residual(over.mean.size());
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (frames[k].has_pose) {
      AddResiduals(rendered.layers, rendered.covered[k], over, levels.of(k),
                   residual, sums);
    } else {
      AddUnexplained(rendered.layers, over, levels.of(k), sums);
    }
  }
  return sums;
}

}  // namespace

core::Expected<ExplainedChange> MeasureExplainedChange(
    Clip& of_levels, const Track& track,
    const ExplainedChangeOptions& options) {
  const std::unique_ptr<Clip> light =
      track.body.gamma ? ViewInLight(of_levels, *track.body.gamma) : nullptr;
  Clip& clip = light ? *light : of_levels;
  CheckArguments(clip, track, options);
  // Frames with a pose: with fewer the body's picture is the frame itself, and
  // explains anything. Not studied.
  constexpr std::ptrdiff_t kMinPoses = 3;
  if (track.poses.empty()) return core::AbsentBecause("no pose was measured");
  const std::vector<SampledFrame> frames = ChooseFrames(clip, track, options);
  if (std::count_if(frames.begin(), frames.end(), [](const SampledFrame& f) {
        return f.has_pose;
      }) < kMinPoses) {
    return core::AbsentBecause(
        fmt::format("of {} sampled frames fewer than {} have a pose",
                    frames.size(), kMinPoses));
  }
  // Two sets of points: near the path the model must explain what changes;
  // elsewhere nothing should change.
  const LatticePoints near = FindNearPoints(clip, track, frames, options);
  const LatticePoints rest = PointsElsewhere(clip, track, frames, options);
  if (near.size() == 0) {
    return core::AbsentBecause("the body's path lies outside the picture");
  }
  const std::size_t n = frames.size();
  const LatticeLevels levels = ReadLevels(clip, frames, near, options.threads);
  const OverTime over = SumOverTime(levels, n, near.size());
  const OverTime over_rest = SumOverTime(
      ReadLevels(clip, frames, rest, options.threads), n, rest.size());
  const LevelNoise pixel_noise(over, over_rest, n);
  const double variance = pixel_noise.usual();

  const Rendered rendered(track, frames, near, levels, options.threads);
  const Residuals sums = SumResiduals(rendered, frames, levels, over);

  ExplainedChange out;
  // A frame within the track without a pose: the body was lost there.
  out.lost = static_cast<int>(std::count_if(
      frames.begin(), frames.end(),
      [](const SampledFrame& f) { return !f.has_pose && f.is_within; }));
  out.frames = static_cast<int>(n);
  out.pixels = static_cast<std::int64_t>(n * near.size());
  out.noise_dn = std::sqrt(variance);
  double all = 0.0;
  for (const float square : over.square) all += square;
  // Both sums have lost a degree of freedom a pixel to the mean, or to B.
  const double noise = variance * static_cast<double>((n - 1) * near.size());
  // Noise alone scatters the sum by sqrt(2 N) s0^2: ten times that is a change.
  // Not studied. Where there is none, what was followed stands still.
  constexpr double kChangeSigmas = 10.0;
  if (all - noise < kChangeSigmas * variance *
                        std::sqrt(2.0 * static_cast<double>(out.pixels))) {
    return out;
  }
  // Share of the change that the model explains, both with the noise taken out.
  const auto share = [&](const Residuals& left) {
    return 1.0 - (left.square - noise) / (all - noise);
  };
  out.near = share(sums);
  out.seen = MeasureSeenArea(rendered.covered, rendered.layers, levels);
  if (track.body.kind == core::BodyKind::kRectangle) {
    Track disc = track;
    disc.body.kind = core::BodyKind::kSphere;
    disc.body.radius_px = track.body.half_short_px;
    out.near_as_disc = share(SumResiduals(
        {disc, frames, near, levels, options.threads}, frames, levels, over));
  }
  const double change_near =
      (all - noise) * static_cast<double>(near.step) * near.step;
  const double change_rest = ChangeBeyondNoise(over_rest, pixel_noise, n) *
                             static_cast<double>(rest.step) * rest.step;
  // Both changes are scaled to areas, since the lattices have different steps.
  out.elsewhere = change_rest / (change_near + change_rest);
  // Mean square over the edge's band in units of the noise: 1 where outline and
  // blur are right.
  out.band_chi2 =
      sums.band > 0
          ? sums.band_square / (static_cast<double>(sums.band) * variance)
          : 0.0;
  return out;
}

}  // namespace touchdown::vision
