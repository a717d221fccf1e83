#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "background/frame_samples.h"
#include "background/mid_mean.h"
#include "background/noise_pairs.h"
#include "footage/box_around.h"
#include "touchdown/core/parallel.h"
#include "touchdown/vision/background/background.h"

namespace touchdown::vision {
namespace {

// How often each pixel of row y was covered in the samples.
const std::uint16_t* RowCounts(const Covers& covers, std::int32_t y) {
  return covers.counts.data() +
         static_cast<std::ptrdiff_t>(y - covers.box.y) * covers.box.width;
}

// Calls use(i) for each of `count` pixels from (x, y) on that is covered.
template <class Use>
void ForEachCovered(const Cover& cover, std::int32_t x, std::int32_t y,
                    std::size_t count, const Use& use) {
  const core::PixelRect& own = cover.box;
  if (y < own.y || y >= own.y + own.height) return;
  const std::uint8_t* const mask =
      cover.mask.data() + static_cast<std::ptrdiff_t>(y - own.y) * own.width;
  const std::int32_t end =
      std::min(x + static_cast<std::int32_t>(count), own.x + own.width);
  for (std::int32_t at = std::max(x, own.x); at < end; ++at) {
    if (mask[at - own.x] != 0) use(static_cast<std::size_t>(at - x));
  }
}

// Adds one sample's mask to the counts.
void Count(const Cover& cover, Covers& covers) {
  const core::PixelRect& own = cover.box;
  for (std::int32_t y = 0; y < own.height; ++y) {
    const std::uint8_t* const mask =
        cover.mask.data() + static_cast<std::ptrdiff_t>(y) * own.width;
    std::uint16_t* const count =
        covers.counts.data() +
        static_cast<std::ptrdiff_t>(own.y + y - covers.box.y) *
            covers.box.width +
        (own.x - covers.box.x);
    for (std::int32_t x = 0; x < own.width; ++x) {
      count[x] = static_cast<std::uint16_t>(count[x] + (mask[x] != 0));
    }
  }
}

// The mid-mean of what is not covered, in the pixels that anything covers.
// Covered samples are moved alternately to the two ends of the order, where
// they change nothing in the middle. Of the rows [top, bottom).
template <class Sample>
void MaskedMidMean(const FrameSamples& samples, const Covers& covers,
                   std::int64_t top, std::int64_t bottom,
                   Background& background) {
  // Samples. Fewer are no background: noise, or the body's rim. Larger leaves
  // more pixels unknown. Not studied.
  constexpr std::size_t kMinSamples = 3;
  const std::size_t n = samples.size();
  const SortingNetwork network(n, SortingNetwork::Order::kFull);
  FrameSamples::Reader reader(samples);
  reader.WillRead({covers.box.x, static_cast<std::int32_t>(top),
                   covers.box.width, static_cast<std::int32_t>(bottom - top)});
  const std::vector<core::Frame>* windows = nullptr;
  std::int32_t windows_end = 0;
  std::int32_t windows_top = 0;
  std::vector<Sample> lanes(n * kLanes);
  std::array<std::size_t, kLanes> low{};   // samples moved below the others
  std::array<std::size_t, kLanes> high{};  // above
  const auto is_touched = [](std::uint16_t count) { return count != 0; };
  for (auto y = static_cast<std::int32_t>(top); y < bottom; ++y) {
    const std::uint16_t* const counts = RowCounts(covers, y);
    const std::uint16_t* const end = counts + covers.box.width;
    const std::uint16_t* const first = std::find_if(counts, end, is_touched);
    if (first == end) continue;
    const auto left = covers.box.x + static_cast<std::int32_t>(first - counts);
    const auto right =
        covers.box.x +
        static_cast<std::int32_t>(
            std::find_if(std::make_reverse_iterator(end),
                         std::make_reverse_iterator(counts), is_touched)
                .base() -
            counts);
    const std::size_t row = static_cast<std::size_t>(y) *
                            static_cast<std::size_t>(background.width_px);
    if (y >= windows_end) {
      const auto rows =
          std::min(kBandRows, static_cast<std::int32_t>(bottom) - y);
      windows = &reader.Read({covers.box.x, y, covers.box.width, rows});
      windows_top = y;
      windows_end = y + rows;
    }
    for (std::int32_t x = left; x < right; x += static_cast<int>(kLanes)) {
      const auto count =
          std::min<std::size_t>(kLanes, static_cast<std::size_t>(right - x));
      const std::size_t at = row + static_cast<std::size_t>(x);
      const std::uint16_t* const touched = counts + (x - covers.box.x);
      if (std::none_of(touched, touched + count, is_touched)) continue;
      low.fill(0);
      high.fill(0);
      for (std::size_t k = 0; k < n; ++k) {
        Sample* const samples_k = &lanes[k * kLanes];
        LoadLanes((*windows)[k], x - covers.box.x, y - windows_top, samples_k);
        ForEachCovered(covers.of[k], x, y, count, [&](std::size_t i) {
          // Alternately below and above all levels: the middle of the order
          // stays that of the uncovered samples.
          const bool down = low[i] == high[i];
          samples_k[i] = down ? Sample{0} : std::numeric_limits<Sample>::max();
          ++(down ? low : high)[i];
        });
      }
      // A full order: how many of the samples count differs from pixel to
      // pixel.
      network.Sort(lanes.data());
      for (std::size_t i = 0; i < count; ++i) {
        if (touched[i] == 0) continue;
        const std::size_t uncovered = n - low[i] - high[i];
        if (uncovered < kMinSamples) {
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
}

// Estimates the noise from the samples themselves.
void EstimateSampleNoise(const FrameSamples& samples, int threads,
                         Background& background) {
  NoisePairs pairs(background.width_px, background.height_px, samples);
  core::InParallel(
      background.height_px, samples.Threads(threads),
      [&](std::int64_t begin, std::int64_t end) {
        FrameSamples::Reader reader(samples);
        const auto top = static_cast<std::int32_t>(begin);
        const auto bottom = static_cast<std::int32_t>(end);
        reader.WillRead({0, top, background.width_px, bottom - top});
        for (std::int32_t y = top; y < bottom; ++y) {
          if (!pairs.Has(y)) continue;
          const auto& row = reader.Read({0, y, background.width_px, 1});
          if (samples.is_16_bit()) {
            pairs.Take<std::uint16_t>(row, 0, y);
          } else {
            pairs.Take<std::uint8_t>(row, 0, y);
          }
        }
      });
  EstimateNoise(pairs, background);
}

}  // namespace

Covers FindCovers(std::int64_t first, std::int64_t last,
                  const CoverFunction& covers,
                  const BackgroundOptions& options) {
  Covers all;
  std::vector<Cover> doubtful;
  for (const std::int64_t index : BackgroundFrames(first, last, options)) {
    Cover cover = covers(index);
    all.box = UnionBox(all.box, cover.box);
    if (!cover.known) {
      doubtful.push_back(std::move(cover));
      continue;
    }
    all.frames.push_back(index);
    all.of.push_back(std::move(cover));
  }
  all.counts.assign(static_cast<std::size_t>(all.box.width) *
                        static_cast<std::size_t>(all.box.height),
                    0);
  for (const Cover& cover : all.of) Count(cover, all);
  if (!all.counts.empty() && !all.of.empty()) {
    all.most = *std::max_element(all.counts.begin(), all.counts.end()) /
               static_cast<double>(all.of.size());
  }
  // Samples in which it is not known whether the body is there are not used,
  // but their pixels are estimated anew as well.
  for (const Cover& cover : doubtful) Count(cover, all);
  return all;
}

Background EstimateMaskedBackground(Clip& clip, const Covers& covers,
                                    Background fallback,
                                    const BackgroundOptions& options) {
  // Nothing is known of the background without the body.
  if (covers.frames.size() < 2) return fallback;
  Background background = std::move(fallback);
  const std::size_t pixels = background.level.size();
  background.unknown.assign(pixels, 0);
  const FrameSamples samples(clip, covers.frames);
  core::InParallel(
      covers.box.height, samples.Threads(options.threads),
      [&](std::int64_t begin, std::int64_t end) {
        if (samples.is_16_bit()) {
          MaskedMidMean<std::uint16_t>(samples, covers, covers.box.y + begin,
                                       covers.box.y + end, background);
        } else {
          MaskedMidMean<std::uint8_t>(samples, covers, covers.box.y + begin,
                                      covers.box.y + end, background);
        }
      });
  if (std::none_of(background.unknown.begin(), background.unknown.end(),
                   [](std::uint8_t u) { return u != 0; })) {
    background.unknown.clear();
  }
  // Share of the picture that the body covered. What is known of the noise
  // comes from all of the picture: levels that change in a smaller part say
  // nothing new, and the estimate, which takes time, stays. Not studied.
  constexpr double kMaxUnchangedShare = 0.05;
  const auto untouched =
      std::count(covers.counts.begin(), covers.counts.end(), std::uint16_t{0});
  if (static_cast<double>(covers.counts.size()) -
          static_cast<double>(untouched) >
      kMaxUnchangedShare * static_cast<double>(pixels)) {
    EstimateSampleNoise(samples, options.threads, background);
  }
  return background;
}

}  // namespace touchdown::vision
