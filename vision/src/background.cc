#include "touchdown/vision/background.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "frame_samples.h"
#include "mid_mean.h"
#include "parallel.h"

namespace touchdown::vision {
namespace {

// The picture is worked on in bands of so many rows: those of all samples stay
// in a processor's own cache.
constexpr std::int32_t kBandRows = 8;

// Neighbouring samples' values at every `step`-th pixel, for the noise.
struct NoisePairs {
  std::size_t step = 1;               // pixels
  std::size_t per_pixel = 0;          // pairs
  std::vector<std::uint16_t> values;  // of pixel, pair, sample

  NoisePairs(std::size_t pixels, std::size_t samples) {
    constexpr std::size_t kWanted = 160'000;  // pairs: 1 % of sigma a bin
    per_pixel = samples / 2;
    step = std::max<std::size_t>(1, pixels * per_pixel / kWanted);
    values.resize((pixels + step - 1) / step * per_pixel * 2);
  }
  std::uint16_t* At(std::size_t pixel) {
    return &values[pixel / step * per_pixel * 2];
  }
};

// Row `y` of a window from its column `x` on, up to kLanes of it.
template <class Sample>
void LoadLanes(const core::Frame& frame, std::int32_t x, std::int32_t y,
               Sample* lanes) {
  const auto count = std::min<std::size_t>(
      kLanes, static_cast<std::size_t>(frame.width_px - x));
  std::memcpy(lanes, frame.row<Sample>(y) + x, count * sizeof(Sample));
}

// The mid-mean of all samples, into rows [begin, end) of `level`.
template <class Sample>
void MidMeanOfRows(FrameSamples::Reader& reader, const SortingNetwork& network,
                   std::size_t n, std::int32_t width, std::int64_t begin,
                   std::int64_t end, float* level, NoisePairs& pairs) {
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
          LoadLanes(windows[k], x, y, &lanes[k * kLanes]);
        }
        network.Sort(lanes.data());
        sums.fill(0);
        for (std::size_t k = cut; k < n - cut; ++k) {
          const Sample* const row = &lanes[k * kLanes];
          for (std::size_t i = 0; i < kLanes; ++i) sums[i] += row[i];
        }
        const auto count =
            std::min<std::size_t>(kLanes, static_cast<std::size_t>(width - x));
        for (std::size_t i = 0; i < count; ++i) {
          out[x + static_cast<std::int32_t>(i)] = static_cast<float>(
              static_cast<double>(sums[i]) / static_cast<double>(n - 2 * cut));
        }
      }
      const std::size_t first =
          static_cast<std::size_t>(top + y) * static_cast<std::size_t>(width);
      const std::size_t last = first + static_cast<std::size_t>(width);
      for (std::size_t i = (first + pairs.step - 1) / pairs.step * pairs.step;
           i < last; i += pairs.step) {
        std::uint16_t* const values = pairs.At(i);
        for (std::size_t k = 0; k < 2 * pairs.per_pixel; ++k) {
          values[k] = windows[k].row<Sample>(y)[i - first];
        }
      }
    }
  }
}

template <class Sample>
void MidMeanOf(const FrameSamples& samples, int threads, Background& background,
               NoisePairs& pairs) {
  const SortingNetwork network(samples.size(), SortingNetwork::Order::kMiddle);
  InParallel(background.height_px, samples.Threads(threads),
             [&](std::int64_t begin, std::int64_t end) {
               FrameSamples::Reader reader(samples);
               MidMeanOfRows<Sample>(reader, network, samples.size(),
                                     background.width_px, begin, end,
                                     background.level.data(), pairs);
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
std::size_t MidMeanBehind(const FrameSamples& samples, const Covers& covers,
                          Background& background) {
  // Fewer samples than this are no background: noise, or the body's rim.
  constexpr std::size_t kLeastSamples = 3;
  const std::size_t n = samples.size();
  const SortingNetwork network(n, SortingNetwork::Order::kFull);
  FrameSamples::Reader reader(samples);
  std::vector<Sample> lanes(n * kLanes);
  std::array<std::size_t, kLanes> low{};   // samples moved below the others
  std::array<std::size_t, kLanes> high{};  // above
  std::size_t most = 0;
  for (std::int32_t y = 0; y < background.height_px; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) *
                            static_cast<std::size_t>(background.width_px);
    const auto begin =
        covers.touched.begin() + static_cast<std::ptrdiff_t>(row);
    const auto end = begin + background.width_px;
    const auto left =
        static_cast<std::int32_t>(std::find(begin, end, 1) - begin);
    if (left == background.width_px) continue;
    const auto right = static_cast<std::int32_t>(
        std::find(std::make_reverse_iterator(end),
                  std::make_reverse_iterator(begin), 1)
            .base() -
        begin);
    const std::vector<core::Frame>& windows =
        reader.Read({left, y, right - left, 1});
    for (std::int32_t x = left; x < right; x += static_cast<int>(kLanes)) {
      const auto count =
          std::min<std::size_t>(kLanes, static_cast<std::size_t>(right - x));
      const std::size_t at = row + static_cast<std::size_t>(x);
      const auto* const touched = &covers.touched[at];
      if (std::none_of(touched, touched + count,
                       [](std::uint8_t t) { return t != 0; })) {
        continue;
      }
      low.fill(0);
      high.fill(0);
      for (std::size_t k = 0; k < n; ++k) {
        Sample* const samples_k = &lanes[k * kLanes];
        LoadLanes(windows[k], x - left, 0, samples_k);
        for (std::size_t i = 0; i < count; ++i) {
          if (!covers.Covered(k, x + static_cast<std::int32_t>(i), y)) continue;
          const bool down = low[i] == high[i];
          samples_k[i] = down ? Sample{0} : std::numeric_limits<Sample>::max();
          ++(down ? low : high)[i];
        }
      }
      network.Sort(lanes.data());
      for (std::size_t i = 0; i < count; ++i) {
        if (touched[i] == 0) continue;
        most = std::max(most, low[i] + high[i]);
        const std::size_t uncovered = n - low[i] - high[i];
        if (uncovered < kLeastSamples) {
          background.unknown[at + i] = 1;
          continue;
        }
        const std::size_t cut = MidBegin(uncovered);
        double sum = 0.0;
        for (std::size_t k = low[i] + cut; k < low[i] + uncovered - cut; ++k) {
          sum += lanes[k * kLanes + i];
        }
        background.level[at + i] =
            static_cast<float>(sum / static_cast<double>(uncovered - 2 * cut));
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
void EstimateNoise(NoisePairs& pairs, Background& background) {
  constexpr std::size_t kBins = 24;
  constexpr std::size_t kMinimumPerBin = 200;
  if (pairs.per_pixel == 0) return;
  const std::size_t pixels = background.level.size();
  float low = background.level[0];
  float high = low;
  for (std::size_t i = 0; i < pixels; i += pairs.step) {
    low = std::min(low, background.level[i]);
    high = std::max(high, background.level[i]);
  }
  const double width = std::max(1e-6, static_cast<double>(high - low));
  std::array<std::vector<float>, kBins> bins;
  for (std::size_t i = 0; i < pixels; i += pairs.step) {
    const auto bin =
        std::min(kBins - 1,
                 static_cast<std::size_t>(
                     (static_cast<double>(background.level[i] - low) / width) *
                     static_cast<double>(kBins)));
    const std::uint16_t* const values = pairs.At(i);
    for (std::size_t k = 0; k < pairs.per_pixel; ++k) {
      const std::uint16_t a = values[2 * k];
      // A clipped sample has no noise to tell of.
      if (a >= background.full_scale_dn || a == 0) continue;
      bins[bin].push_back(static_cast<float>(a) -
                          static_cast<float>(values[2 * k + 1]));
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
  std::vector<std::int64_t> frames;
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
    frames.push_back(index);
    all.of.push_back(std::move(cover));
  }
  // The noise is the fallback's: a body that passes tells nothing of it.
  Background background = fallback;
  if (frames.size() < 2) return background;
  background.unknown.assign(fallback.level.size(), 0);
  const FrameSamples samples(clip, frames);
  const std::size_t most =
      samples.is_16_bit()
          ? MidMeanBehind<std::uint16_t>(samples, all, background)
          : MidMeanBehind<std::uint8_t>(samples, all, background);
  if (most_covered != nullptr) {
    *most_covered =
        static_cast<double>(most) / static_cast<double>(samples.size());
  }
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
  Background background;
  background.width_px = info.width_px;
  background.height_px = info.height_px;
  background.full_scale_dn = static_cast<double>((1u << info.bit_depth) - 1u);
  background.level.resize(static_cast<std::size_t>(info.width_px) *
                          static_cast<std::size_t>(info.height_px));
  const FrameSamples samples(clip, frames);
  NoisePairs pairs(background.level.size(), samples.size());
  if (samples.is_16_bit()) {
    MidMeanOf<std::uint16_t>(samples, options.threads, background, pairs);
  } else {
    MidMeanOf<std::uint8_t>(samples, options.threads, background, pairs);
  }
  EstimateNoise(pairs, background);
  return background;
}

}  // namespace touchdown::vision
