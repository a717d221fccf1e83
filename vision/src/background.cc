#include "touchdown/vision/background.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "both_sides.h"
#include "frame_samples.h"
#include "mid_mean.h"
#include "parallel.h"

namespace touchdown::vision {
namespace {

// The picture is worked on in bands of so many rows: those of all samples stay
// in a processor's own cache.
constexpr std::int32_t kBandRows = 8;

// Neighbouring samples' values at points of the picture, for the noise.
class NoisePairs {
 public:
  NoisePairs(std::int32_t width_px, std::int32_t height_px,
             const FrameSamples& samples)
      : apart_(std::max<std::size_t>(1, samples.size() / kEnough)),
        per_point_(samples.size() / apart_ / 2) {
    // From both ends of the clip to its middle; of an odd number that are all
    // taken the last stays out.
    const std::size_t end = apart_ > 1 ? samples.size() : 2 * per_point_;
    for (std::size_t k = 0; k < per_point_; ++k) taken_.push_back(k * apart_);
    for (std::size_t k = per_point_; k-- > 0;) {
      taken_.push_back(end - 1 - k * apart_);
    }
    // Of a sensor's noise 160 000 pairs tell each bin to 1 %, on any rows. That
    // of compressed pictures differs from place to place in their blocks.
    const bool alike = samples.are_raw();
    row_step_ = alike ? 4 : 1;
    const double wanted = alike ? 160'000 : 640'000;
    const double there = static_cast<double>(width_px) * height_px / row_step_ *
                         static_cast<double>(per_point_);
    const int step = std::max(1, static_cast<int>(there / wanted)) | 1;
    for (const std::size_t x : FromBothSides(static_cast<std::size_t>(width_px),
                                             static_cast<std::size_t>(step))) {
      columns_.push_back(static_cast<std::int32_t>(x));
    }
    rows_ = (height_px + row_step_ - 1) / row_step_;
    values_.resize(columns_.size() * static_cast<std::size_t>(rows_) * 2 *
                   per_point_);
  }

  bool Has(std::int32_t y) const { return y % row_step_ == 0; }
  // Row `y` of the picture is row `row` of each sample's window.
  template <class Sample>
  void Take(const std::vector<core::Frame>& windows, std::int32_t row,
            std::int32_t y) {
    for (std::size_t k = 0; k < 2 * per_point_; ++k) {
      const Sample* const samples = windows[taken_[k]].row<Sample>(row);
      for (std::size_t column = 0; column < columns_.size(); ++column) {
        values_[Point(y / row_step_, column) + k] = samples[columns_[column]];
      }
    }
  }
  // Calls use(x, y, one, other) for each pair, the one nearer to the clip's end
  // first.
  template <class Use>
  void ForEach(const Use& use) const {
    for (std::int32_t row = 0; row < rows_; ++row) {
      for (std::size_t column = 0; column < columns_.size(); ++column) {
        const std::size_t at = Point(row, column);
        for (std::size_t k = 0; k < 2 * per_point_; k += 2) {
          const std::size_t late = k >= per_point_ ? 1 : 0;
          use(columns_[column], row * row_step_, values_[at + k + late],
              values_[at + k + 1 - late]);
        }
      }
    }
  }

 private:
  std::size_t Point(std::int32_t row, std::size_t column) const {
    return (static_cast<std::size_t>(row) * columns_.size() + column) * 2 *
           per_point_;
  }

  // So many samples tell. Of more every second one: frames of compressed video
  // that follow each other share their noise.
  static constexpr std::size_t kEnough = 32;

  std::int32_t row_step_ = 1;
  std::size_t apart_;  // samples from one to the next that is taken
  std::size_t per_point_;
  std::vector<std::size_t> taken_;  // samples
  std::vector<std::int32_t> columns_;
  std::int32_t rows_ = 0;
  std::vector<std::uint16_t> values_;
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
        AddSamples(lanes.data(), cut, n - cut, sums.data());
        const auto count =
            std::min<std::size_t>(kLanes, static_cast<std::size_t>(width - x));
        for (std::size_t i = 0; i < count; ++i) {
          out[x + static_cast<std::int32_t>(i)] = static_cast<float>(
              static_cast<double>(sums[i]) / static_cast<double>(n - 2 * cut));
        }
      }
      if (pairs.Has(top + y)) pairs.Take<Sample>(windows, y, top + y);
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
  // The greatest number of them that cover any one pixel.
  int Most() const {
    int most = 0;
    for (std::size_t k = 0; k < of.size(); ++k) {
      const core::PixelRect& box = of[k].box;
      auto mask = of[k].mask.begin();
      for (std::int32_t y = box.y; y < box.y + box.height; ++y) {
        for (std::int32_t x = box.x; x < box.x + box.width; ++x) {
          if (*mask++ == 0) continue;
          int count = 1;
          for (std::size_t j = 0; j < k; ++j) count += Covered(j, x, y) ? 1 : 0;
          most = std::max(most, count);
        }
      }
    }
    return most;
  }
};

// The mid-mean of what is not covered, in the pixels that anything covers.
// Covered samples are moved alternately to the two ends of the order, where
// they change nothing in the middle.
// Of the rows [top, bottom).
template <class Sample>
void MidMeanBehind(const FrameSamples& samples, const Covers& covers,
                   std::int64_t top, std::int64_t bottom,
                   Background& background) {
  // Fewer samples than this are no background: noise, or the body's rim.
  constexpr std::size_t kLeastSamples = 3;
  const std::size_t n = samples.size();
  const SortingNetwork network(n, SortingNetwork::Order::kFull);
  FrameSamples::Reader reader(samples);
  std::vector<Sample> lanes(n * kLanes);
  std::array<std::size_t, kLanes> low{};   // samples moved below the others
  std::array<std::size_t, kLanes> high{};  // above
  for (auto y = static_cast<std::int32_t>(top); y < bottom; ++y) {
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
}

// Evenly over the range, both ends included; rounded towards the nearer
// one, so that a clip has the same ones when it is played backwards.
std::int64_t SampleIndex(std::int64_t first, std::int64_t last, std::int64_t k,
                         std::int64_t n) {
  if (n == 1) return first;
  const std::int64_t from_end = std::min(k, n - 1 - k);
  const std::int64_t at = from_end * (last - first - 1) / (n - 1);
  return from_end == k ? first + at : last - 1 - at;
}

// Least squares of variance on level over bins of pixels of like level. In each
// bin the variance is robust: (1.4826 * median |difference|)^2 / 2 of
// neighbouring samples' differences, with a correction for whole numbers.
void EstimateNoise(const NoisePairs& pairs, Background& background) {
  constexpr std::size_t kBins = 24;
  constexpr std::size_t kMinimumPerBin = 200;
  float low = std::numeric_limits<float>::infinity();
  float high = -low;
  pairs.ForEach([&](std::int32_t x, std::int32_t y, int, int) {
    low = std::min(low, background.at(x, y));
    high = std::max(high, background.at(x, y));
  });
  if (!(low <= high)) return;
  const double width = std::max(1e-6, static_cast<double>(high - low));
  std::array<std::vector<float>, kBins> bins;
  pairs.ForEach([&](std::int32_t x, std::int32_t y, int one, int other) {
    // A clipped sample has no noise to tell of.
    if (one >= background.full_scale_dn || one == 0) return;
    const auto bin =
        std::min(kBins - 1,
                 static_cast<std::size_t>(
                     (static_cast<double>(background.at(x, y) - low) / width) *
                     static_cast<double>(kBins)));
    bins[bin].push_back(static_cast<float>(one - other));
  });
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

// The noise of the samples themselves.
void EstimateNoiseOf(const FrameSamples& samples, Background& background) {
  NoisePairs pairs(background.width_px, background.height_px, samples);
  FrameSamples::Reader reader(samples);
  for (std::int32_t y = 0; y < background.height_px; ++y) {
    if (!pairs.Has(y)) continue;
    const auto& row = reader.Read({0, y, background.width_px, 1});
    if (samples.is_16_bit()) {
      pairs.Take<std::uint16_t>(row, 0, y);
    } else {
      pairs.Take<std::uint8_t>(row, 0, y);
    }
  }
  EstimateNoise(pairs, background);
}

}  // namespace

double Background::UsualVariance() const {
  constexpr std::int32_t kPlaces = 8;  // across and down
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
  std::vector<Cover> doubtful;
  for (const std::int64_t index :
       BackgroundFrames(first, last, options.samples)) {
    Cover cover = covers(index);
    if (!cover.known) {
      doubtful.push_back(std::move(cover));
      continue;
    }
    frames.push_back(index);
    all.of.push_back(std::move(cover));
  }
  if (frames.size() < 2) return fallback;
  const double share = all.Most() / static_cast<double>(frames.size());
  if (most_covered != nullptr) *most_covered = share;
  all.touched.assign(fallback.level.size(), 0);
  const auto touch = [&](const Cover& cover) {
    const core::PixelRect& box = cover.box;
    for (std::int32_t y = 0; y < box.height; ++y) {
      const std::uint8_t* const mask =
          cover.mask.data() + static_cast<std::ptrdiff_t>(y) * box.width;
      std::uint8_t* const touched =
          all.touched.data() +
          static_cast<std::ptrdiff_t>(box.y + y) * fallback.width_px + box.x;
      for (std::int32_t x = 0; x < box.width; ++x) touched[x] |= mask[x];
    }
  };
  for (const Cover& cover : all.of) touch(cover);
  for (const Cover& cover : doubtful) touch(cover);
  Background background = fallback;
  background.unknown.assign(fallback.level.size(), 0);
  const FrameSamples samples(clip, frames);
  const auto first_row = std::find(all.touched.begin(), all.touched.end(), 1) -
                         all.touched.begin();
  const std::int64_t top = first_row / fallback.width_px;
  const auto after = std::find(all.touched.rbegin(), all.touched.rend(), 1);
  const std::int64_t bottom =
      (all.touched.rend() - after + fallback.width_px - 1) / fallback.width_px;
  InParallel(std::max<std::int64_t>(0, bottom - top),
             samples.Threads(options.threads),
             [&](std::int64_t begin, std::int64_t end) {
               if (samples.is_16_bit()) {
                 MidMeanBehind<std::uint16_t>(samples, all, top + begin,
                                              top + end, background);
               } else {
                 MidMeanBehind<std::uint8_t>(samples, all, top + begin,
                                             top + end, background);
               }
             });
  if (std::none_of(background.unknown.begin(), background.unknown.end(),
                   [](std::uint8_t u) { return u != 0; })) {
    background.unknown.clear();
  }
  // What is known of the noise is known from all of the picture: levels that
  // change in a small part of it say nothing new.
  constexpr double kSmallPart = 0.05;
  const auto touched =
      std::count(all.touched.begin(), all.touched.end(), std::uint8_t{1});
  if (static_cast<double>(touched) >
      kSmallPart * static_cast<double>(all.touched.size())) {
    EstimateNoiseOf(samples, background);
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
  NoisePairs pairs(info.width_px, info.height_px, samples);
  if (samples.is_16_bit()) {
    MidMeanOf<std::uint16_t>(samples, options.threads, background, pairs);
  } else {
    MidMeanOf<std::uint8_t>(samples, options.threads, background, pairs);
  }
  EstimateNoise(pairs, background);
  return background;
}

}  // namespace touchdown::vision
