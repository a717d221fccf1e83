#include "touchdown/vision/background.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace touchdown::vision {
namespace {

// Sampled frames as 16-bit numbers, pixel-interleaved by frame: one plane each.
struct Samples {
  std::size_t pixels = 0;
  std::vector<std::vector<std::uint16_t>> planes;
};

std::vector<std::uint16_t> CopyPlane(const core::Frame& frame) {
  std::vector<std::uint16_t> plane;
  plane.reserve(static_cast<std::size_t>(frame.width_px) *
                static_cast<std::size_t>(frame.height_px));
  for (std::int32_t y = 0; y < frame.height_px; ++y) {
    if (frame.is_16_bit()) {
      const auto* row = frame.row<std::uint16_t>(y);
      plane.insert(plane.end(), row, row + frame.width_px);
    } else {
      const auto* row = frame.row<std::uint8_t>(y);
      plane.insert(plane.end(), row, row + frame.width_px);
    }
  }
  return plane;
}

// Evenly over the range, both ends included.
std::int64_t SampleIndex(std::int64_t first, std::int64_t last, std::int64_t k,
                         std::int64_t n) {
  return n == 1 ? first : first + (k * (last - first - 1)) / (n - 1);
}

Samples ReadSamples(Clip& clip, std::int64_t first, std::int64_t last,
                    int wanted) {
  const std::int64_t n =
      std::min<std::int64_t>(last - first, std::max(wanted, 1));
  Samples samples;
  for (std::int64_t k = 0; k < n; ++k) {
    const std::int64_t index = SampleIndex(first, last, k, n);
    samples.planes.push_back(CopyPlane(clip.Read(index)));
  }
  samples.pixels = samples.planes.front().size();
  return samples;
}

// Mean of the middle half of `values` (reorders them).
float MidMean(std::vector<std::uint16_t>& values) {
  const std::size_t n = values.size();
  if (n <= 2) {
    double sum = 0.0;
    for (const auto v : values) sum += v;
    return static_cast<float>(sum / static_cast<double>(n));
  }
  std::sort(values.begin(), values.end());
  const std::size_t cut = n / 4;
  double sum = 0.0;
  for (std::size_t i = cut; i < n - cut; ++i) sum += values[i];
  return static_cast<float>(sum / static_cast<double>(n - 2 * cut));
}

// Least squares of variance on level over bins of pixels of like level. In each
// bin the variance is robust: (1.4826 * median |difference|)^2 / 2 of
// neighbouring samples' differences, with a correction for whole numbers.
void EstimateNoise(const Samples& samples, Background& background) {
  constexpr std::size_t kBins = 24;
  constexpr std::size_t kPixelsWanted = 40000;  // enough for 1 % of sigma
  constexpr std::size_t kMinimumPerBin = 200;
  if (samples.planes.size() < 2) return;
  const std::size_t step =
      std::max<std::size_t>(1, samples.pixels / kPixelsWanted);
  float low = background.level[0];
  float high = low;
  for (std::size_t i = 0; i < samples.pixels; i += step) {
    low = std::min(low, background.level[i]);
    high = std::max(high, background.level[i]);
  }
  const double width = std::max(1e-6, static_cast<double>(high - low));
  std::array<std::vector<float>, kBins> bins;
  for (std::size_t k = 0; k + 1 < samples.planes.size(); k += 2) {
    const auto& a = samples.planes[k];
    const auto& b = samples.planes[k + 1];
    for (std::size_t i = 0; i < samples.pixels; i += step) {
      // A clipped sample has no noise to tell of.
      if (a[i] >= background.full_scale_dn || a[i] == 0) continue;
      const auto bin = std::min(
          kBins - 1,
          static_cast<std::size_t>(
              (static_cast<double>(background.level[i] - low) / width) *
              static_cast<double>(kBins)));
      bins[bin].push_back(static_cast<float>(a[i]) - static_cast<float>(b[i]));
    }
  }
  double sw = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    auto& d = bins[bin];
    if (d.size() < kMinimumPerBin) continue;
    // The middle 80 % of the differences, whose mean square is a fixed share
    // (0.4377) of a normal variance: robust to the body passing, and fair to
    // noise of less than one DN, where a median would read 0 or 1.
    constexpr double kShareOfVariance = 0.43772;
    for (float& v : d) v = std::abs(v);
    const std::size_t keep = d.size() * 8 / 10;
    std::nth_element(d.begin(), d.begin() + static_cast<std::ptrdiff_t>(keep),
                     d.end());
    double sum = 0.0;
    for (std::size_t i = 0; i < keep; ++i) {
      sum += static_cast<double>(d[i]) * static_cast<double>(d[i]);
    }
    const double variance =
        sum / static_cast<double>(keep) / kShareOfVariance / 2.0;
    const double level = low + width * (static_cast<double>(bin) + 0.5) / kBins;
    const double w = static_cast<double>(d.size());
    sw += w;
    sx += w * level;
    sy += w * variance;
    sxx += w * level * level;
    sxy += w * level * variance;
  }
  if (sw <= 0.0) return;
  const double determinant = sw * sxx - sx * sx;
  double slope = 0.0;
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

}  // namespace

Background EstimateBackgroundBehind(Clip& clip, std::int64_t first,
                                    std::int64_t last,
                                    const CoverFunction& covers,
                                    const Background& fallback,
                                    const BackgroundOptions& options,
                                    double* most_covered) {
  Samples samples;
  std::vector<std::vector<std::uint8_t>> masks;
  const std::int64_t n =
      std::min<std::int64_t>(last - first, std::max(options.samples, 1));
  for (std::int64_t k = 0; k < n; ++k) {
    const std::int64_t index = SampleIndex(first, last, k, n);
    std::vector<std::uint8_t> mask(fallback.level.size(), 0);
    if (!covers(index, mask)) continue;
    samples.planes.push_back(CopyPlane(clip.Read(index)));
    masks.push_back(std::move(mask));
  }
  Background background = fallback;
  if (samples.planes.size() < 2) return background;
  samples.pixels = fallback.level.size();
  background.unknown.assign(samples.pixels, 0);
  // Fewer samples than this are no background: noise, or the body's rim.
  constexpr std::size_t kLeastSamples = 3;
  std::vector<std::uint16_t> values;
  std::size_t most = 0;
  for (std::size_t i = 0; i < samples.pixels; ++i) {
    values.clear();
    for (std::size_t k = 0; k < samples.planes.size(); ++k) {
      if (masks[k][i] == 0) values.push_back(samples.planes[k][i]);
    }
    most = std::max(most, samples.planes.size() - values.size());
    if (values.size() < kLeastSamples) {
      background.unknown[i] = 1;
    } else {
      background.level[i] = MidMean(values);
    }
  }
  if (most_covered != nullptr) {
    *most_covered =
        static_cast<double>(most) / static_cast<double>(samples.planes.size());
  }
  EstimateNoise(samples, background);
  return background;
}

Background EstimateBackground(Clip& clip, std::int64_t first, std::int64_t last,
                              const BackgroundOptions& options) {
  const ClipInfo& info = clip.info();
  if (first < 0 || last > info.frames || first >= last) {
    throw std::invalid_argument(
        fmt::format("frames is {}:{}, must be a range within 0:{}", first, last,
                    info.frames));
  }
  Samples samples = ReadSamples(clip, first, last, options.samples);
  Background background;
  background.width_px = info.width_px;
  background.height_px = info.height_px;
  background.full_scale_dn = static_cast<double>((1u << info.bit_depth) - 1u);
  background.level.resize(samples.pixels);
  std::vector<std::uint16_t> values;
  for (std::size_t i = 0; i < samples.pixels; ++i) {
    values.clear();
    for (const auto& plane : samples.planes) values.push_back(plane[i]);
    background.level[i] = MidMean(values);
  }
  EstimateNoise(samples, background);
  return background;
}

}  // namespace touchdown::vision
