// A film of a camera that moves, exact: the scene is drawn four times as fine,
// and a pixel is the mean of four by four of its pixels, so that a motion by
// quarters of a pixel needs no interpolation.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "tests/pipeline/filmed.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::pipeline::filmed {

inline constexpr std::int32_t kFine = 4;        // pixels to one
inline constexpr std::int32_t kMargin_px = 12;  // of the film, on each side

// Where the scene goes in the picture, in quarters of a pixel.
struct Shake {
  std::int32_t x = 0;
  std::int32_t y = 0;
};
using ShakeOf = std::function<Shake(std::int64_t frame)>;

// A hand: a slow drift, and a tremor over it, by 7 px in all. Frame 0 is where
// a still camera is.
inline Shake ByHand(std::int64_t frame) {
  const auto t = static_cast<double>(frame);
  return {static_cast<std::int32_t>(std::lround(0.2 * t)),
          static_cast<std::int32_t>(
              std::lround(-0.1 * t + 3.0 * std::sin(0.2 * t)))};
}

class ShakenClip : public vision::Clip {
 public:
  // `film` says what a camera that stands still sees.
  ShakenClip(Film film, ShakeOf shake) : shake_(std::move(shake)) {
    vision::SceneCamera& camera = film.camera;
    core::PixelPoint& ground = camera.ground_point;
    const std::int32_t width = camera.width_px;
    const std::int32_t height = camera.height_px;
    camera.width_px = kFine * (width + 2 * kMargin_px);
    camera.height_px = kFine * (height + 2 * kMargin_px);
    // The middle of a pixel lies between its second and third.
    ground.x_px = kFine * (ground.x_px + kMargin_px) + 0.5 * (kFine - 1);
    ground.y_px = kFine * (ground.y_px + kMargin_px) + 0.5 * (kFine - 1);
    camera.px_per_m *= kFine;
    camera.psf_sigma_px *= kFine;
    film.look.texture_correlation_px *= kFine;
    film.noise *= kFine;  // of which the mean of 16 has a quarter
    camera.bit_depth = 12;
    fine_ = vision::OpenScene(BuildScene(film), 1);
    info_ = fine_->info();
    info_.width_px = width;
    info_.height_px = height;
  }

  const vision::ClipInfo& info() const override { return info_; }

 private:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    core::Frame frame = fine_->Read(index);
    const Shake at = shake_(index);
    samples_.clear();
    for (std::int32_t y = window.y; y < window.y + window.height; ++y) {
      for (std::int32_t x = window.x; x < window.x + window.width; ++x) {
        std::uint32_t sum = 0;
        for (std::int32_t j = 0; j < kFine; ++j) {
          for (std::int32_t i = 0; i < kFine; ++i) {
            sum += frame.at(kFine * (x + kMargin_px) - at.x + i,
                            kFine * (y + kMargin_px) - at.y + j);
          }
        }
        samples_.push_back(static_cast<std::uint16_t>(sum / (kFine * kFine)));
      }
    }
    frame.data = reinterpret_cast<const std::byte*>(samples_.data());
    frame.stride_bytes = 2 * static_cast<std::ptrdiff_t>(window.width);
    return frame;
  }

  ShakeOf shake_;
  std::unique_ptr<vision::Clip> fine_;
  vision::ClipInfo info_;
  std::vector<std::uint16_t> samples_;
};

}  // namespace touchdown::pipeline::filmed
