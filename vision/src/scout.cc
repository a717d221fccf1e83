#include "scout.h"

#include <algorithm>
#include <cmath>
#include <cstring>

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

// Until none meets another.
void Join(std::vector<core::PixelRect>& rects) {
  for (std::size_t i = 0; i < rects.size(); ++i) {
    for (std::size_t j = i + 1; j < rects.size();) {
      if (!Meet(rects[i], rects[j])) {
        ++j;
        continue;
      }
      rects[i] = Both(rects[i], rects[j]);
      rects.erase(rects.begin() + static_cast<std::ptrdiff_t>(j));
      j = i + 1;  // it has grown: ask those before again
      for (std::size_t k = 0; k < i; ++k) {
        if (Meet(rects[k], rects[i])) {
          std::swap(rects[k], rects[i]);
          i = k;
          j = i + 1;
          break;
        }
      }
    }
  }
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

// 1, or more where the frame's differences are larger than the still picture's
// noise: flicker, or noise that neighbours share (compression). From every 31st
// sum.
template <class Sample>
double Scout::NoiseOf(const core::Frame& frame) const {
  constexpr std::size_t kStep = 31;
  std::vector<float> off;
  off.reserve(still_.size() / kStep + 1);
  for (std::size_t k = 0; k < still_.size(); k += kStep) {
    const auto row = static_cast<std::int32_t>(k) / segments_;
    const auto segment = static_cast<std::int32_t>(k) % segments_;
    const auto sum = static_cast<float>(
        SumOf(frame.row<Sample>(kFirstRow_px + row * kRowStep_px) +
              segment * kSegment_px));
    off.push_back(std::abs(sum - still_[k].sum) * still_[k].one_over_u);
  }
  if (off.empty()) return 1.0;
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
  std::nth_element(off.begin(), middle, off.end());
  return std::max(1.0, 1.4826 * static_cast<double>(*middle));
}

template <class Sample>
void Scout::Flag(const core::Frame& frame, double threshold,
                 std::vector<std::uint8_t>& cells) const {
  const auto most = static_cast<float>(threshold);
  const Segment* still = still_.data();
  for (std::int32_t y = kFirstRow_px; y < height_px_; y += kRowStep_px) {
    const Sample* const row = frame.row<Sample>(y);
    std::uint8_t* const flags = &cells[static_cast<std::size_t>(y / kCell_px) *
                                       static_cast<std::size_t>(columns_)];
    for (std::int32_t s = 0; s < segments_; ++s, ++still) {
      const auto sum = static_cast<float>(SumOf(row + s * kSegment_px));
      if (std::abs(sum - still->sum) * still->one_over_u > most) {
        flags[s * kSegment_px / kCell_px] = 1;
      }
    }
  }
}

// The boxes of connected cells, with their margin, joined where they meet.
std::vector<core::PixelRect> Scout::Regions(
    std::vector<std::uint8_t> cells) const {
  core::PixelRect all{0, 0, width_px_, height_px_};
  const core::PixelRect& wanted = options_.region;
  if (wanted.width > 0) all = wanted;
  std::vector<core::PixelRect> rects;
  std::vector<std::int32_t> open;
  for (std::int32_t start = 0; start < columns_ * rows_; ++start) {
    if (cells[static_cast<std::size_t>(start)] == 0) continue;
    std::int32_t x0 = columns_, y0 = rows_, x1 = -1, y1 = -1;
    open.assign(1, start);
    cells[static_cast<std::size_t>(start)] = 0;
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
          if (cells[static_cast<std::size_t>(next)] == 0) continue;
          cells[static_cast<std::size_t>(next)] = 0;
          open.push_back(next);
        }
      }
    }
    const std::int32_t m = options_.margin_cells;
    const std::int32_t left = std::max(all.x, (x0 - m) * kCell_px);
    const std::int32_t top = std::max(all.y, (y0 - m) * kCell_px);
    const core::PixelRect rect{
        left, top, std::min(all.x + all.width, (x1 + m + 1) * kCell_px) - left,
        std::min(all.y + all.height, (y1 + m + 1) * kCell_px) - top};
    if (rect.width > 0 && rect.height > 0) rects.push_back(rect);
  }
  Join(rects);
  return rects;
}

Changes Scout::Look(const core::Frame& frame) const {
  Changes changes;
  std::vector<std::uint8_t> cells(
      static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0);
  if (frame.is_16_bit()) {
    changes.noise = NoiseOf<std::uint16_t>(frame);
    Flag<std::uint16_t>(frame, options_.threshold_sigmas * changes.noise,
                        cells);
  } else {
    changes.noise = NoiseOf<std::uint8_t>(frame);
    Flag<std::uint8_t>(frame, options_.threshold_sigmas * changes.noise, cells);
  }
  changes.where = Regions(std::move(cells));
  return changes;
}

std::vector<core::PixelRect> Scout::Differences(const Scout& other) const {
  std::vector<std::uint8_t> cells(
      static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0);
  for (std::size_t k = 0; k < still_.size(); ++k) {
    const auto row = static_cast<std::int32_t>(k) / segments_;
    const auto segment = static_cast<std::int32_t>(k) % segments_;
    const float off =
        std::abs(still_[k].sum - other.still_[k].sum) * still_[k].one_over_u;
    if (static_cast<double>(off) > 0.5 * options_.threshold_sigmas) {
      cells[static_cast<std::size_t>((kFirstRow_px + row * kRowStep_px) /
                                         kCell_px * columns_ +
                                     segment * kSegment_px / kCell_px)] = 1;
    }
  }
  return Regions(std::move(cells));
}

}  // namespace touchdown::vision
