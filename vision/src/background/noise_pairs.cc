#include "background/noise_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "numbers/both_sides.h"

namespace touchdown::vision {

NoisePairs::NoisePairs(std::int32_t width_px, std::int32_t height_px,
                       const FrameSamples& samples)
    : apart_(std::max<std::size_t>(1, samples.size() / kEnoughSamples)),
      per_point_(samples.size() / apart_ / 2) {
  // From both ends of the clip to its middle; of an odd number that are all
  // taken the last stays out.
  const std::size_t end = apart_ > 1 ? samples.size() : 2 * per_point_;
  for (std::size_t k = 0; k < per_point_; ++k) taken_.push_back(k * apart_);
  for (std::size_t k = per_point_; k-- > 0;) {
    taken_.push_back(end - 1 - k * apart_);
  }
  // Pairs of samples of one pixel. Of a sensor's noise 160 000 tell each bin to
  // 1 %, on any rows. Noise of compressed pictures differs from place to place
  // in their blocks: four times as many, on all rows.
  const bool alike = samples.are_raw();
  row_step_ = alike ? 4 : 1;
  const double wanted = alike ? 160'000 : 640'000;
  const double there = static_cast<double>(width_px) * height_px / row_step_ *
                       static_cast<double>(per_point_);
  // An odd step: even ones would meet the same column of each block.
  const int step = std::max(1, static_cast<int>(there / wanted)) | 1;
  for (const std::size_t x : FromBothSides(static_cast<std::size_t>(width_px),
                                           static_cast<std::size_t>(step))) {
    columns_.push_back(static_cast<std::int32_t>(x));
  }
  rows_ = (height_px + row_step_ - 1) / row_step_;
  values_.resize(columns_.size() * static_cast<std::size_t>(rows_) * 2 *
                 per_point_);
}

namespace {

// How often each size of a difference occurs. Differences are whole numbers:
// the smallest ones, and the sum of their squares, follow from the counts.
class DifferenceCounts {
 public:
  void Add(int difference) {
    const auto size = static_cast<std::size_t>(std::abs(difference));
    if (size >= counts_.size()) counts_.resize(2 * size + 1);
    ++counts_[size];
    ++total_;
  }
  std::size_t total() const { return total_; }
  // Of the `keep` smallest.
  double SumOfSquares(std::size_t keep) const {
    double sum = 0.0;
    for (std::size_t size = 0; keep > 0; ++size) {
      const std::size_t some = std::min(keep, counts_[size]);
      sum += static_cast<double>(some) * static_cast<double>(size * size);
      keep -= some;
    }
    return sum;
  }

 private:
  std::vector<std::size_t> counts_;
  std::size_t total_ = 0;
};

}  // namespace

// Variance = floor + slope * level, by least squares over bins of pixels of
// like level. In each bin the variance is that of differences of neighbouring
// samples, halved; the fifth of them that is largest is left out, since the
// body makes it.
void EstimateNoise(const NoisePairs& pairs, Background& background) {
  // Bins of level between the darkest and the brightest pixel. Not studied.
  constexpr std::size_t kBins = 24;
  // Differences in a bin, whose variance is then known to 10 %: a bin with
  // fewer is left out. Not studied.
  constexpr std::size_t kMinPerBin = 200;
  float low = std::numeric_limits<float>::infinity();
  float high = -low;
  pairs.ForEachPoint([&](std::int32_t x, std::int32_t y, const auto&) {
    low = std::min(low, background.at(x, y));
    high = std::max(high, background.at(x, y));
  });
  if (!(low <= high)) return;
  const double width = std::max(1e-6, static_cast<double>(high - low));
  std::array<DifferenceCounts, kBins> bins;
  pairs.ForEachPoint([&](std::int32_t x, std::int32_t y,
                         const auto& for_each_pair) {
    // DN from either end of the scale. A clipped sample has no noise to tell
    // of; nor has a place that is clipped without the body: the samples that
    // are left there are the body's.
    constexpr double kClipMargin_dn = 1.0;
    const auto level = static_cast<double>(background.at(x, y));
    if (level > background.full_scale_dn - kClipMargin_dn ||
        level < kClipMargin_dn)
      return;
    const auto bin =
        std::min(kBins - 1,
                 static_cast<std::size_t>((level - static_cast<double>(low)) /
                                          width * static_cast<double>(kBins)));
    DifferenceCounts& differences = bins[bin];
    for_each_pair([&](int one, int other) {
      if (one >= background.full_scale_dn || one == 0) return;
      differences.Add(one - other);
    });
  });
  double sw = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    const DifferenceCounts& differences = bins[bin];
    if (differences.total() < kMinPerBin) continue;
    // The middle 80 % of the differences have a mean square of this share of a
    // normal variance: int x^2 phi over |x| < 1.2816, divided by 0.8. Robust to
    // the body passing, and fair to noise below one DN, where a median would
    // read 0 or 1.
    constexpr double kShareOfVariance = 0.43772;
    const std::size_t keep = differences.total() * 8 / 10;
    const double sum = differences.SumOfSquares(keep);
    const double variance =
        sum / static_cast<double>(keep) / kShareOfVariance / 2.0;
    const double level = low + width * (static_cast<double>(bin) + 0.5) / kBins;
    const double w = static_cast<double>(differences.total());
    sw += w;
    sx += w * level;
    sy += w * variance;
    sxx += w * level * level;
    sxy += w * level * variance;
  }
  if (sw <= 0.0) return;
  const double determinant = sw * sxx - sx * sx;
  double slope = 0.0;
  // All pixels of one level tell no slope; and noise does not fall with the
  // level.
  if (determinant > 1e-9 * sw * sxx) {
    slope = std::max(0.0, (sw * sxy - sx * sy) / determinant);
  }
  background.noise_slope_dn = slope;
  background.noise_floor_dn2 = (sy - slope * sx) / sw;
  if (background.noise_floor_dn2 < Background::kVarianceFloor_dn2) {
    // Through the mean of the data with no negative variance at level 0.
    background.noise_floor_dn2 = Background::kVarianceFloor_dn2;
    background.noise_slope_dn = std::max(
        0.0, (sy - background.noise_floor_dn2 * sw) / std::max(sx, 1e-9));
  }
}

}  // namespace touchdown::vision
