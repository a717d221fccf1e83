#include "touchdown/vision/background.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "kept_pixels.h"
#include "mid_mean.h"
#include "parallel.h"

namespace touchdown::vision {
namespace {

// Sampled frames: views of the clip's own memory where they last, else copies.
struct Samples {
  std::vector<core::Frame> frames;
  std::vector<KeptPixels> copies;

  std::size_t size() const { return frames.size(); }
  std::uint32_t At(std::size_t k, std::size_t pixel) const {
    const auto width = static_cast<std::size_t>(frames[k].width_px);
    return frames[k].at(static_cast<std::int32_t>(pixel % width),
                        static_cast<std::int32_t>(pixel / width));
  }
};

void AddSample(Clip& clip, std::int64_t index, Samples& samples) {
  const ClipInfo& info = clip.info();
  clip.WillRead(index, {0, 0, info.width_px, info.height_px});
  core::Frame frame = clip.Read(index);
  if (!clip.views_last()) {
    samples.copies.emplace_back(frame);
    frame = samples.copies.back().View();
  }
  samples.frames.push_back(frame);
}

// Row `y` of sample k from column `x` on, up to kLanes of it.
template <class Sample>
void LoadLanes(const core::Frame& frame, std::int32_t x, std::int32_t y,
               Sample* lanes) {
  const auto count = std::min<std::size_t>(
      kLanes, static_cast<std::size_t>(frame.width_px - x));
  std::memcpy(lanes, frame.row<Sample>(y) + x, count * sizeof(Sample));
}

// The mid-mean of all samples, into rows [begin, end) of `level`.
template <class Sample>
void MidMeanOfRows(const Samples& samples, const SortingNetwork& network,
                   std::int64_t begin, std::int64_t end, float* level) {
  const std::size_t n = samples.size();
  const std::size_t cut = MidBegin(n);
  const std::int32_t width = samples.frames.front().width_px;
  std::vector<Sample> lanes(n * kLanes);
  std::array<std::uint32_t, kLanes> sums{};
  for (std::int64_t y = begin; y < end; ++y) {
    for (std::int32_t x = 0; x < width; x += static_cast<int>(kLanes)) {
      for (std::size_t k = 0; k < n; ++k) {
        LoadLanes(samples.frames[k], x, static_cast<std::int32_t>(y),
                  &lanes[k * kLanes]);
      }
      network.Sort(lanes.data());
      sums.fill(0);
      for (std::size_t k = cut; k < n - cut; ++k) {
        const Sample* const row = &lanes[k * kLanes];
        for (std::size_t i = 0; i < kLanes; ++i) sums[i] += row[i];
      }
      const auto count =
          std::min<std::size_t>(kLanes, static_cast<std::size_t>(width - x));
      float* const out = level + y * width + x;
      for (std::size_t i = 0; i < count; ++i) {
        out[i] = static_cast<float>(static_cast<double>(sums[i]) /
                                    static_cast<double>(n - 2 * cut));
      }
    }
  }
}

template <class Sample>
void MidMeanOf(const Samples& samples, int threads, std::vector<float>& level) {
  const SortingNetwork network(samples.size(), SortingNetwork::Order::kMiddle);
  InParallel(samples.frames.front().height_px, threads,
             [&](std::int64_t begin, std::int64_t end) {
               MidMeanOfRows<Sample>(samples, network, begin, end,
                                     level.data());
             });
}

// Where the body was in the samples: the boxes' masks, and for each pixel how
// many of them cover it.
struct Covers {
  std::vector<Cover> of;              // of each sample
  std::vector<std::uint8_t> touched;  // 1 where any cover, used or not, lies
  bool Covered(std::size_t k, std::int32_t x, std::int32_t y) const {
    const Cover& cover = of[k];
    const core::PixelRect& box = cover.box;
    return x >= box.x && y >= box.y && x < box.x + box.width &&
           y < box.y + box.height &&
           cover.mask[static_cast<std::size_t>(y - box.y) *
                          static_cast<std::size_t>(box.width) +
                      static_cast<std::size_t>(x - box.x)] != 0;
  }
};

// The mid-mean of what is not covered, in the pixels that anything covers.
// Covered samples are moved alternately to the two ends of the order, where
// they change nothing in the middle. Returns the most that any pixel is
// covered.
template <class Sample>
std::size_t MidMeanBehind(const Samples& samples, const Covers& covers,
                          Background& background) {
  // Fewer samples than this are no background: noise, or the body's rim.
  constexpr std::size_t kLeastSamples = 3;
  const std::size_t n = samples.size();
  const SortingNetwork network(n, SortingNetwork::Order::kFull);
  std::vector<Sample> lanes(n * kLanes);
  std::array<std::size_t, kLanes> low{};   // samples moved below the others
  std::array<std::size_t, kLanes> high{};  // above
  std::size_t most = 0;
  const std::int32_t width = background.width_px;
  for (std::int32_t y = 0; y < background.height_px; ++y) {
    for (std::int32_t x = 0; x < width; x += static_cast<int>(kLanes)) {
      const auto count =
          std::min<std::size_t>(kLanes, static_cast<std::size_t>(width - x));
      const std::size_t at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
          static_cast<std::size_t>(x);
      const auto* const touched = &covers.touched[at];
      if (std::none_of(touched, touched + count,
                       [](std::uint8_t t) { return t != 0; })) {
        continue;
      }
      low.fill(0);
      high.fill(0);
      for (std::size_t k = 0; k < n; ++k) {
        Sample* const row = &lanes[k * kLanes];
        LoadLanes(samples.frames[k], x, y, row);
        for (std::size_t i = 0; i < count; ++i) {
          if (!covers.Covered(k, x + static_cast<std::int32_t>(i), y)) continue;
          const bool down = low[i] == high[i];
          row[i] = down ? Sample{0} : std::numeric_limits<Sample>::max();
          ++(down ? low : high)[i];
        }
      }
      network.Sort(lanes.data());
      for (std::size_t i = 0; i < count; ++i) {
        if (touched[i] == 0) continue;
        most = std::max(most, low[i] + high[i]);
        const std::size_t left = n - low[i] - high[i];
        if (left < kLeastSamples) {
          background.unknown[at + i] = 1;
          continue;
        }
        const std::size_t cut = MidBegin(left);
        double sum = 0.0;
        for (std::size_t k = low[i] + cut; k < low[i] + left - cut; ++k) {
          sum += lanes[k * kLanes + i];
        }
        background.level[at + i] =
            static_cast<float>(sum / static_cast<double>(left - 2 * cut));
      }
    }
  }
  return most;
}

// Evenly over the range, both ends included.
std::int64_t SampleIndex(std::int64_t first, std::int64_t last, std::int64_t k,
                         std::int64_t n) {
  return n == 1 ? first : first + (k * (last - first - 1)) / (n - 1);
}

// Least squares of variance on level over bins of pixels of like level. In each
// bin the variance is robust: (1.4826 * median |difference|)^2 / 2 of
// neighbouring samples' differences, with a correction for whole numbers.
void EstimateNoise(const Samples& samples, Background& background) {
  constexpr std::size_t kBins = 24;
  constexpr std::size_t kWanted = 160'000;  // differences: 1 % of sigma a bin
  constexpr std::size_t kMinimumPerBin = 200;
  if (samples.size() < 2) return;
  const std::size_t pixels = background.level.size();
  const std::size_t step =
      std::max<std::size_t>(1, pixels * (samples.size() / 2) / kWanted);
  float low = background.level[0];
  float high = low;
  for (std::size_t i = 0; i < pixels; i += step) {
    low = std::min(low, background.level[i]);
    high = std::max(high, background.level[i]);
  }
  const double width = std::max(1e-6, static_cast<double>(high - low));
  std::array<std::vector<float>, kBins> bins;
  for (std::size_t k = 0; k + 1 < samples.size(); k += 2) {
    for (std::size_t i = 0; i < pixels; i += step) {
      const std::uint32_t a = samples.At(k, i);
      // A clipped sample has no noise to tell of.
      if (a >= background.full_scale_dn || a == 0) continue;
      const std::uint32_t b = samples.At(k + 1, i);
      const auto bin = std::min(
          kBins - 1,
          static_cast<std::size_t>(
              (static_cast<double>(background.level[i] - low) / width) *
              static_cast<double>(kBins)));
      bins[bin].push_back(static_cast<float>(a) - static_cast<float>(b));
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

std::vector<std::int64_t> BackgroundFrames(std::int64_t first,
                                           std::int64_t last, int samples) {
  const std::int64_t n =
      std::min<std::int64_t>(last - first, std::max(samples, 1));
  std::vector<std::int64_t> frames;
  for (std::int64_t k = 0; k < n; ++k) {
    frames.push_back(SampleIndex(first, last, k, n));
  }
  return frames;
}

Background EstimateBackgroundBehind(Clip& clip, std::int64_t first,
                                    std::int64_t last,
                                    const CoverFunction& covers,
                                    const Background& fallback,
                                    const BackgroundOptions& options,
                                    double* most_covered) {
  Samples samples;
  Covers all;
  all.touched.assign(fallback.level.size(), 0);
  for (const std::int64_t index :
       BackgroundFrames(first, last, options.samples)) {
    Cover cover = covers(index);
    const core::PixelRect& box = cover.box;
    for (std::int32_t y = 0; y < box.height; ++y) {
      const std::uint8_t* const mask =
          cover.mask.data() + static_cast<std::ptrdiff_t>(y) * box.width;
      std::uint8_t* const touched =
          all.touched.data() +
          static_cast<std::ptrdiff_t>(box.y + y) * fallback.width_px + box.x;
      for (std::int32_t x = 0; x < box.width; ++x) touched[x] |= mask[x];
    }
    if (!cover.known) continue;
    AddSample(clip, index, samples);
    all.of.push_back(std::move(cover));
  }
  Background background = fallback;
  if (samples.size() < 2) return background;
  background.unknown.assign(fallback.level.size(), 0);
  const std::size_t most =
      samples.frames.front().is_16_bit()
          ? MidMeanBehind<std::uint16_t>(samples, all, background)
          : MidMeanBehind<std::uint8_t>(samples, all, background);
  if (most_covered != nullptr) {
    *most_covered =
        static_cast<double>(most) / static_cast<double>(samples.size());
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
  return BackgroundOf(clip, BackgroundFrames(first, last, options.samples),
                      options);
}

Background BackgroundOf(Clip& clip, std::span<const std::int64_t> frames,
                        const BackgroundOptions& options) {
  const ClipInfo& info = clip.info();
  Samples samples;
  for (const std::int64_t index : frames) AddSample(clip, index, samples);
  Background background;
  background.width_px = info.width_px;
  background.height_px = info.height_px;
  background.full_scale_dn = static_cast<double>((1u << info.bit_depth) - 1u);
  background.level.resize(static_cast<std::size_t>(info.width_px) *
                          static_cast<std::size_t>(info.height_px));
  if (samples.frames.front().is_16_bit()) {
    MidMeanOf<std::uint16_t>(samples, options.threads, background.level);
  } else {
    MidMeanOf<std::uint8_t>(samples, options.threads, background.level);
  }
  EstimateNoise(samples, background);
  return background;
}

}  // namespace touchdown::vision
