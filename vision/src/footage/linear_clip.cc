#include "touchdown/vision/footage/linear_clip.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace touchdown::vision {
namespace {

// Bits of the linear levels: a gamma curve spreads dark levels, and undoing it
// needs finer steps than the file's.
std::int32_t LinearDepth(std::int32_t bit_depth) {
  return bit_depth <= 8 ? 12 : 16;
}

std::vector<std::uint16_t> MakeTable(const LightScale& scale) {
  std::vector<std::uint16_t> table(
      static_cast<std::size_t>(scale.full_level_dn) + 1);
  for (std::size_t v = 0; v < table.size(); ++v) {
    table[v] = static_cast<std::uint16_t>(
        std::lround(scale.ToLight(static_cast<double>(v))));
  }
  return table;
}

// A clip whose levels were made linear in light by a table.
class LinearClip final : public Clip {
 public:
  LinearClip(std::unique_ptr<Clip> clip, double gamma)
      : LinearClip(*clip, gamma) {
    owned_ = std::move(clip);
  }
  LinearClip(Clip& clip, double gamma)
      : clip_(&clip), gamma_(gamma), info_(clip.info()) {
    info_.gamma_is_known = true;
    if (gamma != 1.0) {
      table_ = MakeTable(MakeLightScale(info_.bit_depth, gamma));
      info_.bit_depth = LinearDepth(info_.bit_depth);
    }
    set_cancellation(clip_->cancellation());
  }

  const ClipInfo& info() const override { return info_; }
  bool windows_are_cheap() const override { return clip_->windows_are_cheap(); }
  void WillRead(std::int64_t index, const core::PixelRect& window) override {
    clip_->WillRead(index, window);
  }
  void WillReadOnce(std::int64_t index,
                    const core::PixelRect& window) override {
    clip_->WillReadOnce(index, window);
  }
  void HasRead() const override { clip_->HasRead(); }
  std::int64_t EntryFrame(std::int64_t index) const override {
    return clip_->EntryFrame(index);
  }
  const Changes* KnownChanges(std::int64_t index) const override {
    return clip_->KnownChanges(index);
  }
  std::unique_ptr<Clip> Another() const override {
    std::unique_ptr<Clip> another = clip_->Another();
    if (!another) return nullptr;
    return std::make_unique<LinearClip>(std::move(another), gamma_);
  }

 protected:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    const core::Frame seen = clip_->Read(index, window);
    if (table_.empty()) return seen;
    const auto width = static_cast<std::size_t>(window.width);
    samples_.resize(width * static_cast<std::size_t>(window.height));
    for (std::int32_t y = 0; y < window.height; ++y) {
      std::uint16_t* out = &samples_[static_cast<std::size_t>(y) * width];
      if (seen.is_16_bit()) {
        Convert(seen.row<std::uint16_t>(y), width, out);
      } else {
        Convert(seen.row<std::uint8_t>(y), width, out);
      }
    }
    core::Frame frame = seen;
    frame.data = reinterpret_cast<const std::byte*>(samples_.data());
    frame.stride_bytes =
        static_cast<std::ptrdiff_t>(width * sizeof(std::uint16_t));
    frame.bit_depth = info_.bit_depth;
    return frame;
  }

 private:
  // What a file holds beyond its depth is white.
  template <class Sample>
  void Convert(const Sample* levels, std::size_t count,
               std::uint16_t* out) const {
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t level = levels[i];
      out[i] = level < table_.size() ? table_[level] : table_.back();
    }
  }

  std::unique_ptr<Clip> owned_;  // null: another's
  Clip* clip_;
  double gamma_;
  ClipInfo info_;
  std::vector<std::uint16_t> table_;  // empty: levels are light as they are
  std::vector<std::uint16_t> samples_;
};

}  // namespace

double LightScale::ToLight(double level_dn) const {
  return full_light_dn *
         std::pow(std::max(level_dn, 0.0) / full_level_dn, 1.0 / gamma);
}

double LightScale::ToLevel(double light_dn) const {
  return full_level_dn *
         std::pow(std::max(light_dn, 0.0) / full_light_dn, gamma);
}

LightScale MakeLightScale(std::int32_t bit_depth, double gamma) {
  const auto full = [](std::int32_t bits) {
    return std::exp2(static_cast<double>(bits)) - 1.0;
  };
  return {full(bit_depth), full(LinearDepth(bit_depth)), gamma};
}

std::unique_ptr<Clip> MakeLinear(std::unique_ptr<Clip> clip, double gamma) {
  return std::make_unique<LinearClip>(std::move(clip), gamma);
}

std::unique_ptr<Clip> ViewInLight(Clip& clip, double gamma) {
  return std::make_unique<LinearClip>(clip, gamma);
}

}  // namespace touchdown::vision
