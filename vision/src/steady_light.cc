#include "touchdown/vision/steady_light.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <unordered_map>
#include <utility>
#include <vector>

#include "touchdown/core/errors.h"
#include "track_shape.h"

namespace touchdown::vision {
namespace {

// A grid of points and what they are under steady light.
class Grid {
 public:
  Grid(const ClipInfo& info, int points) {
    const double area = static_cast<double>(info.width_px) * info.height_px;
    step_ = std::max(1, static_cast<int>(std::sqrt(area / points)));
    width_ = info.width_px;
    height_ = info.height_px;
    full_ = (1 << info.bit_depth) - 1;
  }

  std::vector<float> Look(const core::Frame& frame) const {
    std::vector<float> levels;
    for (std::int32_t y = step_ / 2; y < height_; y += step_) {
      for (std::int32_t x = step_ / 2; x < width_; x += step_) {
        levels.push_back(static_cast<float>(frame.at(x, y)));
      }
    }
    return levels;
  }

  void SetSteady(std::vector<float> steady) { steady_ = std::move(steady); }

  // Whether enough of the picture is below full scale to tell the light. Behind
  // a backlit body all is saturated: what is left is the body, and it moves.
  bool Tells() const {
    constexpr double kLeast = 0.25;  // share of the points
    const auto usable =
        std::count_if(steady_.begin(), steady_.end(),
                      [this](float r) { return IsUsable(0.0F, r); });
    return static_cast<double>(usable) >=
           kLeast * static_cast<double>(steady_.size());
  }

  // Least squares of v = g r without points off by more than 4 sigma.
  double GainOf(const std::vector<float>& levels) const {
    double gain = 1.0;
    double most_off = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kRounds; ++round) {
      double over = 0.0;
      double under = 0.0;
      std::vector<double> off;
      for (std::size_t i = 0; i < levels.size(); ++i) {
        const double v = static_cast<double>(levels[i]);
        const double r = static_cast<double>(steady_[i]);
        if (!IsUsable(levels[i], steady_[i])) continue;
        const double residual = std::abs(v - gain * r);
        if (residual > most_off) continue;
        over += v * r;
        under += r * r;
      }
      if (under <= 0.0) return 1.0;
      gain = over / under;
      for (std::size_t i = 0; i < levels.size(); ++i) {
        const double v = static_cast<double>(levels[i]);
        if (!IsUsable(levels[i], steady_[i])) continue;
        off.push_back(std::abs(v - gain * static_cast<double>(steady_[i])));
      }
      // Half a level: what rounding alone leaves.
      most_off = 4.0 * std::max(0.5, 1.4826 * Median(std::move(off)));
    }
    return gain;
  }

 private:
  bool IsUsable(float level, float steady) const {
    return level < static_cast<float>(full_) && steady > 0.0F &&
           steady < static_cast<float>(full_);
  }

  static constexpr int kRounds = 5;
  std::int32_t step_ = 1;
  std::int32_t width_ = 0;
  std::int32_t height_ = 0;
  std::int32_t full_ = 255;
  std::vector<float> steady_;
};

class CorrectedClip final : public Clip {
 public:
  CorrectedClip(std::unique_ptr<Clip> clip, Grid grid, double least_gain)
      : clip_(std::move(clip)), grid_(std::move(grid)), info_(clip_->info()) {
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
    const double gain = GainOf(index);
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
  double GainOf(std::int64_t index) {
    const auto known = gains_.find(index);
    if (known != gains_.end()) return known->second;
    const double gain = grid_.GainOf(grid_.Look(clip_->Read(index)));
    gains_[index] = gain;
    return gain;
  }

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

}  // namespace

SteadyLight SteadyLightOf(std::unique_ptr<Clip> clip, std::int64_t first,
                          std::int64_t last,
                          const SteadyLightOptions& options) {
  const ClipInfo& info = clip->info();
  if (first < 0 || last > info.frames || first >= last) {
    throw std::invalid_argument(
        fmt::format("frames is {}:{}, must be a range within 0:{}", first, last,
                    info.frames));
  }
  Grid grid(info, options.points);
  std::vector<std::vector<float>> looks;
  const auto frames = static_cast<std::int64_t>(
      std::clamp<double>(std::ceil(options.look_s * info.time_base.fps),
                         options.least_frames, options.most_frames));
  // So many looks give the spread to an eighth.
  constexpr std::int64_t kLooks = 34;
  const std::int64_t step = std::max<std::int64_t>(1, frames / kLooks);
  const std::int64_t end = std::min<std::int64_t>(last, first + frames);
  for (std::int64_t index = first; index < end; index += step) {
    try {
      looks.push_back(grid.Look(clip->Read(index)));
    } catch (const core::InputError&) {
      if (index == first) throw;
      break;
    }
  }
  SteadyLight light;
  std::vector<float> steady(looks.front().size());
  std::vector<double> column(looks.size());
  for (std::size_t i = 0; i < steady.size(); ++i) {
    for (std::size_t k = 0; k < looks.size(); ++k) {
      column[k] = static_cast<double>(looks[k][i]);
    }
    steady[i] = static_cast<float>(Median(column));
  }
  grid.SetSteady(std::move(steady));
  light.told = grid.Tells();
  if (!light.told) {
    light.clip = std::move(clip);
    return light;
  }
  std::vector<double> gains;
  gains.reserve(looks.size());
  for (const auto& look : looks) gains.push_back(grid.GainOf(look));
  double mean = 0.0;
  for (const double g : gains) mean += g / static_cast<double>(gains.size());
  double square = 0.0;
  for (const double g : gains) square += (g - mean) * (g - mean);
  light.spread = std::sqrt(square / static_cast<double>(gains.size()));
  light.corrected = light.spread > options.least_spread;
  if (!light.corrected) {
    light.clip = std::move(clip);
    return light;
  }
  // Room for frames that are brighter or darker than those that were sampled.
  constexpr double kRoom = 0.9;
  const double least = kRoom * *std::min_element(gains.begin(), gains.end());
  light.clip = std::make_unique<CorrectedClip>(std::move(clip), std::move(grid),
                                               std::clamp(least, 0.05, 1.0));
  return light;
}

}  // namespace touchdown::vision
