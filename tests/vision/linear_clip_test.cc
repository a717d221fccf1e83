// Levels turned back into light.
#include "touchdown/vision/footage/linear_clip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

namespace touchdown::vision {
namespace {

// Each sample shows its own place: x + 16 y + the frame.
class Ramp final : public Clip {
 public:
  explicit Ramp(std::int32_t bit_depth) {
    info_.width_px = 16;
    info_.height_px = 12;
    info_.bit_depth = bit_depth;
    info_.frames = 3;
  }
  const ClipInfo& info() const override { return info_; }

 protected:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    const bool wide = info_.bit_depth > 8;
    samples_.clear();
    for (std::int32_t y = 0; y < window.height; ++y) {
      for (std::int32_t x = 0; x < window.width; ++x) {
        const auto level = static_cast<std::uint16_t>(
            window.x + x + 16 * (window.y + y) + index);
        samples_.push_back(static_cast<std::uint8_t>(level & 0xffU));
        if (wide) samples_.push_back(static_cast<std::uint8_t>(level >> 8U));
      }
    }
    core::Frame frame;
    frame.data = reinterpret_cast<const std::byte*>(samples_.data());
    frame.stride_bytes = window.width * (wide ? 2 : 1);
    frame.bit_depth = info_.bit_depth;
    frame.time_s = 0.5 * static_cast<double>(index);
    return frame;
  }

 private:
  ClipInfo info_;
  std::vector<std::uint8_t> samples_;
};

TEST(LinearClip, LightIsThePowerOfTheLevel) {
  for (const std::int32_t depth : {8, 10}) {
    const auto clip = MakeLinear(std::make_unique<Ramp>(depth), 0.5);
    EXPECT_EQ(clip->info().bit_depth, depth == 8 ? 12 : 16);
    const core::Frame frame = clip->Read(2, {3, 4, 7, 5});
    EXPECT_EQ(frame.bit_depth, clip->info().bit_depth);
    EXPECT_EQ(frame.index, 2);
    EXPECT_EQ(frame.time_s, 1.0);
    EXPECT_EQ(frame.origin_x_px, 3);
    const double full = std::exp2(depth) - 1.0;
    const double full_out = std::exp2(clip->info().bit_depth) - 1.0;
    for (std::int32_t y = 0; y < 5; ++y) {
      for (std::int32_t x = 0; x < 7; ++x) {
        const double level = 3 + x + 16 * (4 + y) + 2;
        EXPECT_NEAR(frame.at(x, y), full_out * std::pow(level / full, 2.0),
                    0.51);
      }
    }
  }
}

TEST(LinearClip, OfGammaOneIsTheSameAndKnownToBeLight) {
  const auto clip = MakeLinear(std::make_unique<Ramp>(8), 1.0);
  EXPECT_TRUE(clip->info().gamma_is_known);
  EXPECT_EQ(clip->info().bit_depth, 8);
  const core::Frame frame = clip->Read(0);
  EXPECT_EQ(frame.bit_depth, 8);
  EXPECT_EQ(frame.at(5, 6), 101.0);
}

TEST(LinearClip, AViewShowsTheSameAndKnowsThatItIsLight) {
  Ramp levels(8);
  const auto view = ViewInLight(levels, 0.45);
  const auto whole = MakeLinear(std::make_unique<Ramp>(8), 0.45);
  EXPECT_FALSE(levels.info().gamma_is_known);
  EXPECT_TRUE(view->info().gamma_is_known);
  EXPECT_TRUE(whole->info().gamma_is_known);
  for (const std::int32_t x : {0, 7, 15}) {
    EXPECT_EQ(view->Read(1).at(x, 9), whole->Read(1).at(x, 9));
  }
}

TEST(LightScale, LevelsComeBackFromTheirLight) {
  for (const std::int32_t depth : {8, 12}) {
    const LightScale scale = MakeLightScale(depth, 0.45);
    EXPECT_EQ(scale.ToLight(scale.full_level_dn), scale.full_light_dn);
    for (const double level : {0.0, 1.0, 30.0, 255.0}) {
      EXPECT_NEAR(scale.ToLevel(scale.ToLight(level)), level, 1e-9);
    }
    EXPECT_EQ(scale.ToLight(-3.0), 0.0);
  }
}

}  // namespace
}  // namespace touchdown::vision
