#include "detection/scout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "footage/box_around.h"
#include "footage/kept_pixels.h"
#include "numbers/lanes.h"

namespace touchdown::vision {
namespace {

// The header's, under a short name.
constexpr std::int32_t kCell_px = Scout::kCell_px;
// Samples of a row that are summed: a 64-bit word of bytes. More sees fainter
// changes of larger bodies; fewer sees smaller bodies.
constexpr std::int32_t kSegment_px = 8;
// Rows 2, 6, 10, ... are read. More rows see smaller bodies and cost time in
// proportion. Not studied.
constexpr std::int32_t kRowStep_px = 4;
constexpr std::int32_t kFirstRow_px = 2;

// Mostly none is.
TOUCHDOWN_WIDEST
bool AnyExceeds(const float* values, std::size_t count, float most) {
  int beyond = 0;
  for (std::size_t i = 0; i < count; ++i) beyond |= values[i] > most ? 1 : 0;
  return beyond != 0;
}

// How far the sums of eight samples of a row are off those of the still
// picture, in standard deviations.
TOUCHDOWN_WIDEST
void OffInRow(const std::uint8_t* __restrict row, std::size_t count,
              const float* __restrict sum, const float* __restrict per_u,
              float* __restrict off) {
  // Every second byte: two halves of a word are added as four 16-bit numbers,
  // in which sums of bytes cannot overflow.
  constexpr std::uint64_t kEven = 0x00FF00FF00FF00FFULL;
  for (std::size_t s = 0; s < count; ++s) {
    std::uint64_t eight = 0;
    std::memcpy(&eight, row + s * kSegment_px, sizeof eight);
    std::uint64_t sums = (eight & kEven) + (eight >> 8 & kEven);
    sums += sums >> 32;
    sums += sums >> 16;
    const auto all = static_cast<std::int32_t>(sums & 0xFFFF);
    off[s] = std::abs(static_cast<float>(all) - sum[s]) * per_u[s];
  }
}

TOUCHDOWN_WIDEST
void OffInRow(const std::uint16_t* __restrict row, std::size_t count,
              const float* __restrict sum, const float* __restrict per_u,
              float* __restrict off) {
  for (std::size_t s = 0; s < count; ++s) {
    std::int32_t all = 0;
    for (int i = 0; i < kSegment_px; ++i) all += row[s * kSegment_px + i];
    off[s] = std::abs(static_cast<float>(all) - sum[s]) * per_u[s];
  }
}

bool Meet(const core::PixelRect& a, const core::PixelRect& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height &&
         b.y < a.y + a.height;
}

// A box of connected cells that differ.
struct ChangedRegion {
  core::PixelRect rect;
  double strength = 0.0;  // sum of its differences, in standard deviations
};

// Joins regions that meet until none meets another.
void Join(std::vector<ChangedRegion>& regions) {
  for (std::size_t i = 0; i < regions.size();) {
    const auto meets =
        std::find_if(regions.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                     regions.end(), [&](const ChangedRegion& other) {
                       return Meet(regions[i].rect, other.rect);
                     });
    if (meets == regions.end()) {
      ++i;
      continue;
    }
    regions[i].rect = UnionBox(regions[i].rect, meets->rect);
    regions[i].strength += meets->strength;
    regions.erase(meets);
    // It has grown: all are asked again.
    std::swap(regions[0], regions[i]);
    i = 0;
  }
}

// The value at `share` of the sorted values. `larger` of them are above
// `bound`: where it is one of these, only they are sorted.
double Quantile(std::vector<float>& values, double share, float bound,
                std::size_t larger) {
  if (values.empty()) return 0.0;
  auto at =
      static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::size_t kept = values.size();
  if (at >= values.size() - larger) {
    at -= values.size() - larger;
    kept = 0;
    for (const float value : values) {
      values[kept] = value;  // written always, kept or not: no branch
      kept += static_cast<std::size_t>(value > bound);
    }
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(at);
  std::nth_element(values.begin(), middle,
                   values.begin() + static_cast<std::ptrdiff_t>(kept));
  return static_cast<double>(*middle);
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
      sum_.push_back(static_cast<float>(sum));
      per_u_.push_back(static_cast<float>(1.0 / u));
    }
  }
}

// The frame's noise over that of the still picture: 1, or more where all
// differences are larger (flicker, compression). From every seventh sum:
// `typical` is the median, `tail` the median over parts of the picture of the
// 98 % point, which a body in a few of the parts does not change. Less than a
// tenth more is not told from 1, so that counting is enough in most frames.
Scout::Noise Scout::MeasureNoise(const std::vector<float>& off) const {
  // Every seventh sum is enough for quantiles to 1 %. Not studied beyond that.
  constexpr std::size_t kStep = 7;
  // Parts across and down: a body fills some of the 16.
  constexpr std::size_t kParts = 4;
  // Quantiles of |normal|: half, and 98 %.
  constexpr double kMedianOfNormal = 0.6745;
  constexpr double kHighOfNormal = 2.3263;
  constexpr double kHighShare = 0.98;
  // Ratio below which the noise counts as 1. Smaller sorts in every frame.
  constexpr double kMinToldRatio = 1.1;
  constexpr auto kLarge = static_cast<float>(kMinToldRatio * kMedianOfNormal);
  constexpr auto kBeyond = static_cast<float>(kMinToldRatio * kHighOfNormal);
  const std::size_t segments = At(segments_);
  const std::size_t all_rows = off.size() / std::max<std::size_t>(1, segments);
  std::array<std::vector<float>, kParts * kParts> parts;
  for (auto& part : parts) {
    part.reserve(off.size() / (kStep * parts.size()) + segments);
  }
  std::size_t large = 0;
  std::size_t count = 0;
  for (std::size_t row = 0, s = 0; row < all_rows; ++row) {
    const std::size_t down = row * kParts / all_rows * kParts;
    for (; s < segments; s += kStep) {
      const float value = off[row * segments + s];
      parts[down + s * kParts / segments].push_back(value);
      large += value > kLarge;
      ++count;
    }
    s -= segments;
  }
  Noise noise;
  if (count == 0) return noise;
  if (2 * large >= count) {
    std::vector<float> some;
    for (const auto& part : parts) {
      some.insert(some.end(), part.begin(), part.end());
    }
    noise.typical = Quantile(some, 0.5, kLarge, large) / kMedianOfNormal;
  }
  std::vector<float> high;
  for (std::vector<float>& part : parts) {
    if (part.empty()) continue;
    const auto beyond = static_cast<std::size_t>(std::count_if(
        part.begin(), part.end(), [](float value) { return value > kBeyond; }));
    const double share =
        static_cast<double>(beyond) / static_cast<double>(part.size());
    high.push_back(
        share < 1.0 - kHighShare
            ? 1.0F
            : static_cast<float>(Quantile(part, kHighShare, kBeyond, beyond)));
  }
  noise.tail =
      std::max(noise.typical, Quantile(high, 0.5, 0.0F, 0) / kHighOfNormal);
  return noise;
}

// How far each sum of the rows looked at is off, in standard deviations.
// `row_of(y)` gives a window whose first row is row y of the picture.
template <class RowOf>
std::vector<float> Scout::Off(const Rows& rows, const RowOf& row_of) const {
  const std::size_t segments = At(segments_);
  std::vector<float> off;
  off.reserve(sum_.size() / rows.step + segments);
  for (std::size_t k = rows.first; k < rows_looked_at(); k += rows.step) {
    const core::Frame row =
        row_of(kFirstRow_px + static_cast<std::int32_t>(k) * kRowStep_px);
    off.resize(off.size() + segments);
    float* const out = &off[off.size() - segments];
    const float* const sum = &sum_[k * segments];
    const float* const per_u = &per_u_[k * segments];
    if (row.is_16_bit()) {
      OffInRow(row.row<std::uint16_t>(0), segments, sum, per_u, out);
    } else {
      OffInRow(row.row<std::uint8_t>(0), segments, sum, per_u, out);
    }
  }
  return off;
}

// The next row to be read is fetched ahead.
std::vector<float> Scout::Off(const core::Frame& frame,
                              const Rows& rows) const {
  const auto ahead = static_cast<std::int32_t>(rows.step) * kRowStep_px;
  return Off(rows, [&](std::int32_t y) {
    if (y + ahead < height_px_) {
      Prefetch(frame.row<std::byte>(y + ahead), RowBytes(frame));
    }
    return CutWindow(frame, {0, y, width_px_, 1});
  });
}

std::vector<float> Scout::Off(Clip& clip, std::int64_t index,
                              const Rows& rows) const {
  if (clip.windows_are_cheap() && rows.step > 1) {
    return Off(rows, [&](std::int32_t y) {
      const core::PixelRect row = {0, y, width_px_, 1};
      clip.WillReadOnce(index, row);
      return clip.Read(index, row);
    });
  }
  clip.WillRead(index, {0, 0, width_px_, height_px_});
  // Where rows must be unpacked, only those looked at are.
  if (clip.windows_are_cheap() && !clip.views_last()) {
    return Off(rows, [&](std::int32_t y) {
      return clip.Read(index, {0, y, width_px_, 1});
    });
  }
  return Off(clip.Read(index), rows);
}

// Sums that exceed the threshold mark their cell; the strength of a cell is
// their sum.
Changes Scout::FindChanges(const std::vector<float>& off) const {
  const Noise noise = MeasureNoise(off);
  const auto most = static_cast<float>(options_.threshold_sigmas * noise.tail);
  std::vector<float> cells(At(columns_) * At(rows_), 0.0F);
  const std::size_t segments = At(segments_);
  for (std::size_t row = 0; row * segments < off.size(); ++row) {
    const std::size_t y = At(kFirstRow_px) + row * At(kRowStep_px);
    float* const flags = &cells[y / At(kCell_px) * At(columns_)];
    if (!AnyExceeds(&off[row * segments], segments, most)) continue;
    for (std::size_t s = 0; s < segments; ++s) {
      const float value = off[row * segments + s];
      if (value > most) flags[s * At(kSegment_px) / At(kCell_px)] += value;
    }
  }
  return {Regions(std::move(cells)), noise.typical};
}

Changes Scout::Look(const core::Frame& frame) const {
  return FindChanges(Off(frame, Rows{}));
}

Changes Scout::Look(Clip& clip, std::int64_t index) const {
  return FindChanges(Off(clip, index, Rows{}));
}

bool Scout::Glimpse(Clip& clip, std::int64_t index, int phase) const {
  // A probe reads every fourth row, from `phase` on: four probes in turn read
  // them all.
  constexpr std::size_t kPhases = 4;
  const std::vector<float> off =
      Off(clip, index, {static_cast<std::size_t>(phase) % kPhases, kPhases});
  const auto most =
      static_cast<float>(options_.threshold_sigmas * MeasureNoise(off).tail);
  return AnyExceeds(off.data(), off.size(), most);
}

// Boxes of connected cells with their margin, joined where they meet, the
// strongest first. Flood fill over eight neighbours.
std::vector<core::PixelRect> Scout::Regions(std::vector<float> cells) const {
  core::PixelRect all{0, 0, width_px_, height_px_};
  const core::PixelRect& wanted = options_.region;
  if (wanted.width > 0) all = wanted;
  std::vector<ChangedRegion> regions;
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
  std::stable_sort(regions.begin(), regions.end(),
                   [](const ChangedRegion& a, const ChangedRegion& b) {
                     return a.strength > b.strength;
                   });
  if (regions.size() > options_.most_regions) {
    regions.resize(options_.most_regions);
  }
  std::vector<core::PixelRect> rects;
  rects.reserve(regions.size());
  for (const ChangedRegion& region : regions) rects.push_back(region.rect);
  return rects;
}

// Whether two still pictures differ as if one held a body's ghost.
bool Scout::Differs(const Scout& other) const {
  std::vector<float> off;
  for (std::size_t k = 0; k < sum_.size(); ++k) {
    off.push_back(std::abs(sum_[k] - other.sum_[k]) * per_u_[k]);
  }
  const double most = options_.threshold_sigmas * MeasureNoise(off).tail;
  std::vector<int> cells(At(columns_) * At(rows_), 0);
  for (std::size_t k = 0; k < sum_.size(); ++k) {
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
    // Of the eight sums of a cell. Key frames of compressed video differ here
    // and there from the others; a ghost does so in all of its area. Smaller
    // decodes clips again for nothing. Not studied.
    constexpr int kMinDifferingSums = 3;
    if (++cells[static_cast<std::size_t>(y / kCell_px * columns_ +
                                         x / kCell_px)] >= kMinDifferingSums) {
      return true;
    }
  }
  return false;
}

}  // namespace touchdown::vision
