#include "scout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace touchdown::vision {
namespace {

constexpr std::int32_t kCell_px = 16;
constexpr std::int32_t kSegment_px = 8;
constexpr std::int32_t kRowStep_px = 4;
constexpr std::int32_t kFirstRow_px = 2;  // rows 2, 6, 10, ...

// Sum of eight bytes: pairs, then all four by one product.
std::uint32_t SumOf(const std::uint8_t* samples) {
  constexpr std::uint64_t kEven = 0x00FF00FF00FF00FFULL;
  std::uint64_t eight = 0;
  std::memcpy(&eight, samples, sizeof eight);
  const std::uint64_t pairs = (eight & kEven) + (eight >> 8 & kEven);
  return static_cast<std::uint32_t>(pairs * 0x0001000100010001ULL >> 48);
}

std::uint32_t SumOf(const std::uint16_t* samples) {
  std::uint32_t sum = 0;
  for (int i = 0; i < kSegment_px; ++i) sum += samples[i];
  return sum;
}

bool Meet(const core::PixelRect& a, const core::PixelRect& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height &&
         b.y < a.y + a.height;
}

core::PixelRect Both(const core::PixelRect& a, const core::PixelRect& b) {
  const std::int32_t x = std::min(a.x, b.x);
  const std::int32_t y = std::min(a.y, b.y);
  return {x, y, std::max(a.x + a.width, b.x + b.width) - x,
          std::max(a.y + a.height, b.y + b.height) - y};
}

struct Region {
  core::PixelRect rect;
  double strength = 0.0;  // sum of its differences, in standard deviations
};

// Until none meets another.
void Join(std::vector<Region>& regions) {
  for (std::size_t i = 0; i < regions.size();) {
    const auto meets = std::find_if(
        regions.begin() + static_cast<std::ptrdiff_t>(i) + 1, regions.end(),
        [&](const Region& other) { return Meet(regions[i].rect, other.rect); });
    if (meets == regions.end()) {
      ++i;
      continue;
    }
    regions[i].rect = Both(regions[i].rect, meets->rect);
    regions[i].strength += meets->strength;
    regions.erase(meets);
    // It has grown: all are asked again.
    std::swap(regions[0], regions[i]);
    i = 0;
  }
}

double Quantile(std::vector<float>& values, double share) {
  if (values.empty()) return 0.0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(
                           share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return static_cast<double>(*at);
}

}  // namespace

Scout::Scout(const Background& still, const ScoutOptions& options)
    : options_(options),
      width_px_(still.width_px),
      height_px_(still.height_px),
      columns_((width_px_ + kCell_px - 1) / kCell_px),
      rows_((height_px_ + kCell_px - 1) / kCell_px),
      segments_(width_px_ / kSegment_px) {
  for (std::int32_t y = kFirstRow_px; y < height_px_; y += kRowStep_px) {
    for (std::int32_t s = 0; s < segments_; ++s) {
      double sum = 0.0;
      for (std::int32_t i = 0; i < kSegment_px; ++i) {
        sum += static_cast<double>(still.at(s * kSegment_px + i, y));
      }
      const double u =
          std::sqrt(kSegment_px * still.Variance(sum / kSegment_px));
      still_.push_back({static_cast<float>(sum), static_cast<float>(1.0 / u)});
    }
  }
}

// How far a sum is off the still picture's, in standard deviations.
template <class Sample>
float Scout::Off(const Sample* samples, const Segment& still) const {
  return std::abs(static_cast<float>(SumOf(samples)) - still.sum) *
         still.one_over_u;
}

// 1, or more where the differences are larger than the still picture's noise:
// flicker, or noise that neighbours share (compression). `off`: of every
// `step`-th sum. The median, and the median over parts of the picture of the
// 98 % point, which a body in a few of the parts does not change.
Scout::Noise Scout::NoiseOf(std::vector<float> off, std::size_t step) const {
  constexpr std::int32_t kParts = 4;  // across and down
  constexpr double kMedianOfNormal = 0.6745;
  constexpr double kHighOfNormal = 2.3263;
  const auto all_rows = static_cast<std::int32_t>(
      still_.size() / static_cast<std::size_t>(std::max(1, segments_)));
  std::array<std::vector<float>, std::size_t{kParts} * kParts> parts;
  for (std::size_t i = 0; i < off.size(); ++i) {
    const auto k = static_cast<std::int32_t>(i * step);
    parts[static_cast<std::size_t>(k / segments_ * kParts / all_rows * kParts +
                                   k % segments_ * kParts / segments_)]
        .push_back(off[i]);
  }
  std::vector<float> high;
  for (std::vector<float>& part : parts) {
    if (!part.empty()) high.push_back(static_cast<float>(Quantile(part, 0.98)));
  }
  Noise noise;
  noise.typical = std::max(1.0, Quantile(off, 0.5) / kMedianOfNormal);
  noise.tail = std::max(noise.typical, Quantile(high, 0.5) / kHighOfNormal);
  return noise;
}

template <class Sample>
Changes Scout::LookAt(const core::Frame& frame) const {
  std::vector<float> cells(
      static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_),
      0.0F);
  constexpr std::size_t kStep = 7;
  std::vector<float> some;
  some.reserve(still_.size() / kStep + 1);
  for (std::size_t k = 0; k < still_.size(); k += kStep) {
    const auto at = static_cast<std::int32_t>(k);
    some.push_back(
        Off(frame.row<Sample>(kFirstRow_px + at / segments_ * kRowStep_px) +
                std::ptrdiff_t{at % segments_} * kSegment_px,
            still_[k]));
  }
  const Noise noise = NoiseOf(std::move(some), kStep);
  const auto most = static_cast<float>(options_.threshold_sigmas * noise.tail);
  const Segment* still = still_.data();
  for (std::int32_t y = kFirstRow_px; y < height_px_; y += kRowStep_px) {
    const Sample* const row = frame.row<Sample>(y);
    float* const flags = &cells[static_cast<std::size_t>(y / kCell_px) *
                                static_cast<std::size_t>(columns_)];
    for (std::int32_t s = 0; s < segments_; ++s, ++still) {
      const float off = Off(row + std::ptrdiff_t{s} * kSegment_px, *still);
      if (off > most) flags[s * kSegment_px / kCell_px] += off;
    }
  }
  return {Regions(std::move(cells)), noise.typical};
}

// The boxes of connected cells, with their margin, joined where they meet.
std::vector<core::PixelRect> Scout::Regions(std::vector<float> cells) const {
  core::PixelRect all{0, 0, width_px_, height_px_};
  const core::PixelRect& wanted = options_.region;
  if (wanted.width > 0) all = wanted;
  std::vector<Region> regions;
  for (const core::PixelRect& rect : options_.always) {
    regions.push_back({rect, std::numeric_limits<double>::infinity()});
  }
  std::vector<std::int32_t> open;
  for (std::int32_t start = 0; start < columns_ * rows_; ++start) {
    if (cells[static_cast<std::size_t>(start)] == 0.0F) continue;
    std::int32_t x0 = columns_, y0 = rows_, x1 = -1, y1 = -1;
    double strength = 0.0;
    const auto visit = [&](std::int32_t cell) {
      strength += static_cast<double>(
          std::exchange(cells[static_cast<std::size_t>(cell)], 0.0F));
      open.push_back(cell);
    };
    visit(start);
    while (!open.empty()) {
      const std::int32_t x = open.back() % columns_;
      const std::int32_t y = open.back() / columns_;
      open.pop_back();
      x0 = std::min(x0, x);
      x1 = std::max(x1, x);
      y0 = std::min(y0, y);
      y1 = std::max(y1, y);
      for (std::int32_t v = std::max(0, y - 1); v <= std::min(rows_ - 1, y + 1);
           ++v) {
        for (std::int32_t u = std::max(0, x - 1);
             u <= std::min(columns_ - 1, x + 1); ++u) {
          const std::int32_t next = v * columns_ + u;
          if (cells[static_cast<std::size_t>(next)] != 0.0F) visit(next);
        }
      }
    }
    const std::int32_t m = options_.margin_cells;
    const std::int32_t left = std::max(all.x, (x0 - m) * kCell_px);
    const std::int32_t top = std::max(all.y, (y0 - m) * kCell_px);
    const core::PixelRect rect{
        left, top, std::min(all.x + all.width, (x1 + m + 1) * kCell_px) - left,
        std::min(all.y + all.height, (y1 + m + 1) * kCell_px) - top};
    if (rect.width > 0 && rect.height > 0) regions.push_back({rect, strength});
  }
  Join(regions);
  std::stable_sort(
      regions.begin(), regions.end(),
      [](const Region& a, const Region& b) { return a.strength > b.strength; });
  if (regions.size() > options_.most_regions) {
    regions.resize(options_.most_regions);
  }
  std::vector<core::PixelRect> rects;
  rects.reserve(regions.size());
  for (const Region& region : regions) rects.push_back(region.rect);
  return rects;
}

Changes Scout::Look(const core::Frame& frame) const {
  return frame.is_16_bit() ? LookAt<std::uint16_t>(frame)
                           : LookAt<std::uint8_t>(frame);
}

bool Scout::Differs(const Scout& other) const {
  std::vector<float> off;
  for (std::size_t k = 0; k < still_.size(); ++k) {
    off.push_back(std::abs(still_[k].sum - other.still_[k].sum) *
                  still_[k].one_over_u);
  }
  const double most = options_.threshold_sigmas * NoiseOf(off, 1).tail;
  std::vector<int> cells(
      static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0);
  for (std::size_t k = 0; k < still_.size(); ++k) {
    if (static_cast<double>(off[k]) <= most) continue;
    const std::int32_t x =
        static_cast<std::int32_t>(k) % segments_ * kSegment_px;
    const std::int32_t y =
        kFirstRow_px + static_cast<std::int32_t>(k) / segments_ * kRowStep_px;
    if (std::any_of(options_.always.begin(), options_.always.end(),
                    [&](const auto& rect) {
                      return Meet(rect, {x, y, kSegment_px, 1});
                    })) {
      continue;
    }
    // Key frames of compressed video differ here and there from the others; a
    // ghost does so in all of its area.
    constexpr int kMany = 3;  // of the eight sums of a cell
    if (++cells[static_cast<std::size_t>(y / kCell_px * columns_ +
                                         x / kCell_px)] >= kMany) {
      return true;
    }
  }
  return false;
}

}  // namespace touchdown::vision
