#include "touchdown/vision/background/background.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "background/frame_samples.h"
#include "background/mid_mean.h"
#include "background/noise_pairs.h"
#include "touchdown/core/parallel.h"

namespace touchdown::vision {
namespace {

// The mid-mean of all samples, into rows [begin, end) of `level`.
template <class Sample>
void MidMeanOfRows(FrameSamples::Reader& reader, const SortingNetwork& network,
                   std::size_t n, std::int32_t width, std::int64_t begin,
                   std::int64_t end, float* level, NoisePairs& pairs) {
  // Interquartile mean of each pixel over the samples: the middle half, after
  // sorting. A body that covers a pixel in less than a quarter of the samples
  // does not change it.
  const std::size_t cut = MidBegin(n);
  std::vector<Sample> lanes(n * kLanes);
  std::array<std::uint32_t, kLanes> sums{};
  for (auto top = static_cast<std::int32_t>(begin); top < end;
       top += kBandRows) {
    const std::int32_t rows =
        std::min(kBandRows, static_cast<std::int32_t>(end) - top);
    const std::vector<core::Frame>& windows =
        reader.Read({0, top, width, rows});
    for (std::int32_t y = 0; y < rows; ++y) {
      float* const out = level + static_cast<std::ptrdiff_t>(top + y) * width;
      for (std::int32_t x = 0; x < width; x += static_cast<int>(kLanes)) {
        for (std::size_t k = 0; k < n; ++k) {
          // The next row lies after this one. There are more pictures than
          // streams that a processor foresees.
          __builtin_prefetch(windows[k].row<Sample>(y) + x + width);
          LoadLanes(windows[k], x, y, &lanes[k * kLanes]);
        }
        // Only as far as the middle needs it.
        network.Sort(lanes.data());
        AddSamples(lanes.data(), cut, n - cut, sums.data());
        const auto count =
            std::min<std::size_t>(kLanes, static_cast<std::size_t>(width - x));
        for (std::size_t i = 0; i < count; ++i) {
          out[x + static_cast<std::int32_t>(i)] = static_cast<float>(
              static_cast<double>(sums[i]) / static_cast<double>(n - 2 * cut));
        }
      }
      // The samples are at hand here: what tells the noise is taken in passing.
      if (pairs.Has(top + y)) pairs.Take<Sample>(windows, y, top + y);
    }
  }
}

template <class Sample>
void ComputeMidMean(const FrameSamples& samples, int threads,
                    Background& background, NoisePairs& pairs) {
  const SortingNetwork network(samples.size(), SortingNetwork::Order::kMiddle);
  core::InParallel(background.height_px, samples.Threads(threads),
                   [&](std::int64_t begin, std::int64_t end) {
                     FrameSamples::Reader reader(samples);
                     reader.WillRead({0, static_cast<std::int32_t>(begin),
                                      background.width_px,
                                      static_cast<std::int32_t>(end - begin)});
                     MidMeanOfRows<Sample>(reader, network, samples.size(),
                                           background.width_px, begin, end,
                                           background.level.data(), pairs);
                   });
}

// The k-th of n frames, evenly over the range with both ends included; rounded
// towards the nearer end, so that a clip has the same ones when it is played
// backwards.
std::int64_t SampleIndex(std::int64_t first, std::int64_t last, std::int64_t k,
                         std::int64_t n) {
  if (n == 1) return first;
  const std::int64_t from_end = std::min(k, n - 1 - k);
  const std::int64_t at = from_end * (last - first - 1) / (n - 1);
  return from_end == k ? first + at : last - 1 - at;
}

}  // namespace

double Background::UsualVariance() const {
  // Places across and down, whose mean level stands for the picture's. Not
  // studied.
  constexpr std::int32_t kPlaces = 8;
  // Evenly from both sides to the middle: the same ones in a mirror.
  const auto place = [](std::int32_t i, std::int32_t size_px) {
    const std::int32_t from_side = std::min(i, kPlaces - 1 - i);
    const std::int32_t at = (2 * from_side + 1) * size_px / (2 * kPlaces);
    return i == from_side ? at : size_px - 1 - at;
  };
  double sum = 0.0;
  for (std::int32_t j = 0; j < kPlaces; ++j) {
    for (std::int32_t i = 0; i < kPlaces; ++i) {
      sum += static_cast<double>(at(place(i, width_px), place(j, height_px)));
    }
  }
  return Variance(sum / (kPlaces * kPlaces));
}

Background InLight(const Background& background, const LightScale& scale) {
  Background light = background;
  light.full_scale_dn = scale.full_light_dn;
  double variance = 0.0;
  for (float& level : light.level) {
    // DN of light by DN of level; black has noise, too.
    const double at = std::max(static_cast<double>(level), 1.0);
    const double seen = scale.ToLight(at);
    const double slope = seen / at / scale.gamma;
    variance += slope * slope * background.Variance(at);
    level = static_cast<float>(seen);
  }
  light.noise_floor_dn2 = variance / static_cast<double>(light.level.size());
  light.noise_slope_dn = 0.0;
  return light;
}

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

std::vector<std::int64_t> BackgroundFrames(std::int64_t first,
                                           std::int64_t last,
                                           const BackgroundOptions& options) {
  const std::vector<std::int64_t>& among = options.among;
  // Frames that are kept whole are read for nothing: samples are taken from
  // those.
  const auto begin = std::lower_bound(among.begin(), among.end(), first);
  const auto end = std::lower_bound(begin, among.end(), last);
  if (begin == end) return BackgroundFrames(first, last, options.samples);
  std::vector<std::int64_t> frames;
  for (const std::int64_t k :
       BackgroundFrames(0, end - begin, options.samples)) {
    frames.push_back(begin[k]);
  }
  return frames;
}

Background EstimateBackground(Clip& clip, std::int64_t first, std::int64_t last,
                              const BackgroundOptions& options) {
  const ClipInfo& info = clip.info();
  if (first < 0 || last > info.frames || first >= last) {
    throw std::invalid_argument(
        fmt::format("frames is {}:{}, must be a range within 0:{}", first, last,
                    info.frames));
  }
  return EstimateBackgroundFromFrames(
      clip, BackgroundFrames(first, last, options), options);
}

Background EstimateBackgroundFromFrames(Clip& clip,
                                        std::span<const std::int64_t> frames,
                                        const BackgroundOptions& options) {
  const ClipInfo& info = clip.info();
  Background background;
  background.width_px = info.width_px;
  background.height_px = info.height_px;
  // Full scale of right-aligned samples.
  background.full_scale_dn = static_cast<double>((1u << info.bit_depth) - 1u);
  background.level.resize(static_cast<std::size_t>(info.width_px) *
                          static_cast<std::size_t>(info.height_px));
  const FrameSamples samples(clip, frames);
  NoisePairs pairs(info.width_px, info.height_px, samples);
  if (samples.is_16_bit()) {
    ComputeMidMean<std::uint16_t>(samples, options.threads, background, pairs);
  } else {
    ComputeMidMean<std::uint8_t>(samples, options.threads, background, pairs);
  }
  EstimateNoise(pairs, background);
  return background;
}

}  // namespace touchdown::vision
