#include "touchdown/vision/background/steady_light.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <unordered_map>
#include <utility>
#include <vector>

#include "background/mid_mean.h"
#include "footage/read_apart.h"
#include "numbers/robust.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/parallel.h"

namespace touchdown::vision {
namespace {

// A grid of points, with their levels under steady light, from which a frame's
// gain is measured.
class Grid {
 public:
  Grid(const ClipInfo& info, int points) {
    const double area = static_cast<double>(info.width_px) * info.height_px;
    step_ = std::max(1, static_cast<int>(std::sqrt(area / points)));
    width_ = info.width_px;
    height_ = info.height_px;
    full_ = (1 << info.bit_depth) - 1;
  }

  // Levels of a frame at the points of the grid.
  std::vector<float> Look(const core::Frame& frame) const {
    std::vector<float> levels;
    for (std::int32_t y = step_ / 2; y < height_; y += step_) {
      AddRow(frame, y, levels);
    }
    return levels;
  }

  // Of a frame of the clip: its rows alone where that is less.
  std::vector<float> Look(Clip& clip, std::int64_t index) const {
    if (!clip.windows_are_cheap()) return Look(clip.Read(index));
    std::vector<float> levels;
    for (std::int32_t y = step_ / 2; y < height_; y += step_) {
      const core::PixelRect row = {0, y, width_, 1};
      clip.WillReadOnce(index, row);
      AddRow(clip.Read(index, row), 0, levels);
    }
    return levels;
  }

  void SetSteady(std::vector<float> steady) { steady_ = std::move(steady); }

  // Whether enough of the picture is below full scale to tell the light. Behind
  // a backlit body all is saturated: what is left is the body, and it moves.
  bool Tells() const {
    // Share of the points. Not studied.
    constexpr double kMinUsable = 0.25;
    const auto usable =
        std::count_if(steady_.begin(), steady_.end(),
                      [this](float r) { return IsUsable(0.0F, r); });
    return static_cast<double>(usable) >=
           kMinUsable * static_cast<double>(steady_.size());
  }

  // The gain where most of the light is.
  double EstimateMedianGain(const std::vector<float>& levels) const {
    // One point in four: the noise is 2.5 times that of EstimateGain, and far
    // below what is taken out.
    constexpr std::size_t kStep = 4;
    return MedianGain(Usable(levels, kStep));
  }

  // Least squares of v = g r, without points that are off by more than 4 sigma.
  // It begins at the median gain: least squares of all points are drawn to a
  // body that hides a tenth of the picture, and would leave it in.
  double EstimateGain(const std::vector<float>& levels) const {
    const Points points = Usable(levels);
    double gain = MedianGain(points);
    double most_off = MostOff(points, gain);
    for (int round = 0; round < kMaxRounds; ++round) {
      const double gain_before = gain;
      const double most_before = most_off;
      double over = 0.0;
      double under = 0.0;
      for (const auto& [v, r] : points) {
        const bool is_light = !(std::abs(v - gain * r) > most_off);
        over += is_light ? v * r : 0.0;
        under += is_light ? r * r : 0.0;
      }
      if (under <= 0.0) return 1.0;
      // Least squares through the origin.
      gain = over / under;
      most_off = MostOff(points, gain);
      if (gain == gain_before && most_off == most_before) break;
    }
    return gain;
  }

 private:
  using Gains = std::vector<std::pair<double, double>>;  // with what they count
  struct Point {
    double level = 0.0;
    double steady = 0.0;
  };
  using Points = std::vector<Point>;

  Points Usable(const std::vector<float>& levels, std::size_t step = 1) const {
    Points points(levels.size());
    std::size_t count = 0;
    for (std::size_t i = 0; i < levels.size(); i += step) {
      points[count] = {static_cast<double>(levels[i]),
                       static_cast<double>(steady_[i])};
      count += IsUsable(levels[i], steady_[i]) ? 1 : 0;
    }
    points.resize(count);
    return points;
  }

  // The gain of the least sum of |v - g r|: the median of v / r, each point
  // counted r times. Right as long as a body hides less than half of the light.
  static double MedianGain(const Points& points) {
    Gains gains(points.size());
    double all = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto& [v, r] = points[i];
      gains[i] = {v / r, r};
      all += r;
    }
    if (gains.empty()) return 1.0;
    double below = KeepNearMiddle(gains, all);
    // Weighted median by bisection: only the half that holds it is put in
    // order.
    auto first = gains.begin();
    auto last = gains.end();
    while (last - first > 1) {
      const auto middle = first + (last - first) / 2;
      std::nth_element(first, middle, last);
      double left = below;
      for (auto at = first; at != middle; ++at) left += at->second;
      if (2.0 * left >= all) {
        last = middle;
      } else {
        below = left;
        first = middle;
      }
    }
    return first->first;
  }

  // Keeps, of many numbers, those among which half of `all` is reached; returns
  // the weight of those left out below. Levels are whole numbers, so that their
  // sums are exact in any order.
  static double KeepNearMiddle(Gains& gains, double all) {
    if (gains.size() < kManyNumbers) return 0.0;
    const auto [low, high] = BracketOfMedian(
        gains.size(), [&](std::size_t i) { return gains[i].first; });
    Gains near(gains.size());
    double below = 0.0;
    double within = 0.0;
    std::size_t kept = 0;
    for (const auto& gain : gains) {
      near[kept] = gain;
      const bool holds = gain.first >= low && gain.first <= high;
      below += gain.first < low ? gain.second : 0.0;
      within += holds ? gain.second : 0.0;
      kept += holds ? 1 : 0;
    }
    if (2.0 * below >= all || 2.0 * (below + within) < all) return 0.0;
    near.resize(kept);
    gains = std::move(near);
    return below;
  }

  // How far a point may be off before it counts as the body's.
  static double MostOff(const Points& points, double gain) {
    std::vector<double> off(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      off[i] = std::abs(points[i].level - gain * points[i].steady);
    }
    if (off.empty()) return 0.0;
    // Robust standard deviations, of at least half a level, which rounding
    // alone leaves. Not studied.
    constexpr double kMaxOffSigmas = 4.0;
    return kMaxOffSigmas *
           std::max(0.5, kSigmaPerMedian * Median(std::move(off)));
  }

  void AddRow(const core::Frame& frame, std::int32_t row,
              std::vector<float>& levels) const {
    for (std::int32_t x = step_ / 2; x < width_; x += step_) {
      levels.push_back(static_cast<float>(frame.at(x, row)));
    }
  }
  bool IsUsable(float level, float steady) const {
    return level < static_cast<float>(full_) && steady > 0.0F &&
           steady < static_cast<float>(full_);
  }

  // Rounds of rejection; most frames settle sooner. Not studied.
  static constexpr int kMaxRounds = 5;
  std::int32_t step_ = 1;
  std::int32_t width_ = 0;
  std::int32_t height_ = 0;
  std::int32_t full_ = 255;
  std::vector<float> steady_;
};

// A clip whose frames are divided by their gain, in 16 bits: rounding to the
// clip's own bits would add noise.
class CorrectedClip final : public Clip {
 public:
  CorrectedClip(std::unique_ptr<Clip> clip, Grid grid, double least_gain)
      : clip_(std::move(clip)), grid_(std::move(grid)), info_(clip_->info()) {
    set_cancellation(clip_->cancellation());
    full_ = (1 << info_.bit_depth) - 1;
    info_.bit_depth = kBits;
    per_level_ = least_gain * kFull / full_;
  }

  const ClipInfo& info() const override { return info_; }

  std::int64_t EntryFrame(std::int64_t index) const override {
    return clip_->EntryFrame(index);
  }

 protected:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    const double gain = EstimateGain(index);
    const core::Frame raw = clip_->Read(index, window);
    samples_.resize(static_cast<std::size_t>(raw.width_px) *
                    static_cast<std::size_t>(raw.height_px));
    const double factor = per_level_ / gain;
    std::size_t i = 0;
    for (std::int32_t y = 0; y < raw.height_px; ++y) {
      for (std::int32_t x = 0; x < raw.width_px; ++x) {
        const auto v = static_cast<std::int32_t>(raw.at(x, y));
        const double steady = v >= full_ ? kFull : factor * v;
        samples_[i++] =
            static_cast<std::uint16_t>(std::lround(std::min(steady, kFull)));
      }
    }
    core::Frame frame = raw;
    frame.data = reinterpret_cast<const std::byte*>(samples_.data());
    frame.stride_bytes = 2 * static_cast<std::ptrdiff_t>(raw.width_px);
    frame.bit_depth = kBits;
    return frame;
  }

 private:
  double EstimateGain(std::int64_t index) {
    const auto known = gains_.find(index);
    if (known != gains_.end()) return known->second;
    const double gain = grid_.EstimateGain(grid_.Look(clip_->Read(index)));
    gains_[index] = gain;
    return gain;
  }

  // Bits and full scale of the corrected samples.
  static constexpr int kBits = 16;
  static constexpr double kFull = 65535.0;
  std::unique_ptr<Clip> clip_;
  Grid grid_;
  ClipInfo info_;
  std::int32_t full_ = 255;
  double per_level_ = 1.0;
  std::unordered_map<std::int64_t, double> gains_;
  std::vector<std::uint16_t> samples_;
};

// Looks at these frames, up to the first that cannot be read.
std::vector<std::vector<float>> SampleGrid(
    Clip& clip, const Grid& grid, std::span<const std::int64_t> indices,
    int threads) {
  std::vector<std::vector<float>> looks;
  if (CanReadApart(clip)) {
    looks.resize(indices.size());
    try {
      ReadApart(clip, indices.size(), threads,
                [&](Clip& reader, std::size_t i) {
                  looks[i] = grid.Look(reader, indices[i]);
                });
      return looks;
    } catch (const core::InputError&) {
      looks.clear();  // one by one: up to the damage
    }
  }
  for (const std::int64_t index : indices) {
    try {
      looks.push_back(grid.Look(clip, index));
    } catch (const core::InputError&) {
      if (looks.empty()) throw;
      break;
    }
  }
  return looks;
}

// Median over the frames, point by point. Levels are whole numbers of at most
// 16 bits, which a sorting network puts in order.
std::vector<float> PointwiseMedians(
    const std::vector<std::vector<float>>& looks) {
  const SortingNetwork network(looks.size(), SortingNetwork::Order::kFull);
  std::vector<std::uint16_t> lanes(looks.size() * kLanes);
  std::vector<float> medians(looks.front().size());
  for (std::size_t begin = 0; begin < medians.size(); begin += kLanes) {
    const std::size_t count = std::min(kLanes, medians.size() - begin);
    for (std::size_t k = 0; k < looks.size(); ++k) {
      for (std::size_t i = 0; i < count; ++i) {
        lanes[k * kLanes + i] = static_cast<std::uint16_t>(looks[k][begin + i]);
      }
    }
    network.Sort(lanes.data());
    std::copy_n(
        lanes.begin() + static_cast<std::ptrdiff_t>(looks.size() / 2 * kLanes),
        count, medians.begin() + static_cast<std::ptrdiff_t>(begin));
  }
  return medians;
}

double StandardDeviation(const std::vector<double>& gains) {
  double mean = 0.0;
  for (const double g : gains) mean += g / static_cast<double>(gains.size());
  double square = 0.0;
  for (const double g : gains) square += (g - mean) * (g - mean);
  return std::sqrt(square / static_cast<double>(gains.size()));
}

}  // namespace

SteadyLight Deflicker(std::unique_ptr<Clip> clip, std::int64_t first,
                      std::int64_t last, const SteadyLightOptions& options) {
  const ClipInfo& info = clip->info();
  if (first < 0 || last > info.frames || first >= last) {
    throw std::invalid_argument(
        fmt::format("frames is {}:{}, must be a range within 0:{}", first, last,
                    info.frames));
  }
  Grid grid(info, options.points);
  // As many frames as the stated time holds, between a least and a greatest
  // number.
  const auto frames = static_cast<std::int64_t>(
      std::clamp<double>(std::ceil(options.look_s * info.time_base.fps),
                         options.least_frames, options.most_frames));
  // Frames looked at: they give the spread to an eighth, 1/sqrt(2 n). More cost
  // time.
  constexpr std::int64_t kGridLooks = 34;
  const std::int64_t step = std::max<std::int64_t>(1, frames / kGridLooks);
  const std::int64_t end = std::min<std::int64_t>(last, first + frames);
  std::vector<std::int64_t> indices;
  for (std::int64_t index = first; index < end; index += step) {
    indices.push_back(index);
  }
  const std::vector<std::vector<float>> looks =
      SampleGrid(*clip, grid, indices, options.threads);
  SteadyLight light;
  grid.SetSteady(PointwiseMedians(looks));
  light.told = grid.Tells();
  if (!light.told) {
    light.clip = std::move(clip);
    return light;
  }
  std::vector<double> gains(looks.size());
  const auto measure = [&](double (Grid::*gain_of)(const std::vector<float>&)
                               const) {
    core::InParallel(static_cast<std::int64_t>(looks.size()), options.threads,
                     [&](std::int64_t from, std::int64_t to) {
                       for (auto k = static_cast<std::size_t>(from);
                            k < static_cast<std::size_t>(to); ++k) {
                         gains[k] = (grid.*gain_of)(looks[k]);
                       }
                     });
    light.spread = StandardDeviation(gains);
  };
  // Share of the limit. In most clips the light is steady, and the cheap median
  // gain is far from any doubt: only above this share the better gain is
  // computed. Not studied.
  constexpr double kDoubtShare = 0.5;
  measure(&Grid::EstimateMedianGain);
  if (light.spread > kDoubtShare * options.least_spread)
    measure(&Grid::EstimateGain);
  light.corrected = light.spread > options.least_spread;
  if (!light.corrected) {
    light.clip = std::move(clip);
    return light;
  }
  // Share of the least gain: room for frames that are darker than those that
  // were sampled. Smaller costs resolution; larger clips such frames. Not
  // studied.
  constexpr double kGainRoom = 0.9;
  const double least =
      kGainRoom * *std::min_element(gains.begin(), gains.end());
  light.clip = std::make_unique<CorrectedClip>(std::move(clip), std::move(grid),
                                               std::clamp(least, 0.05, 1.0));
  return light;
}

}  // namespace touchdown::vision
