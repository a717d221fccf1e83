// A long rendered clip of a small picture: a sphere flies in, bounces, leaves.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>

#include "touchdown/vision/synthetic/render.h"

namespace touchdown::vision::testing {

// 0.75 px a frame over 480 of `frames` frames, from frame 100 on; contact in
// frame 340.
inline Scene LongScene(std::int64_t frames, std::int32_t bit_depth = 8) {
  Scene scene;
  scene.camera.width_px = 320;
  scene.camera.height_px = 160;
  scene.camera.px_per_m = 1000.0;
  scene.camera.ground_point = {0.0, 130.0};
  scene.camera.fps = 1000.0;
  scene.camera.bit_depth = bit_depth;
  scene.body = core::Sphere({0.024, 0.0});
  scene.frames = frames;
  scene.noise = {1.5, 0.02};
  scene.pose = [](double t) {
    const double since = t - 0.340;
    const double gap = since < 0.0 ? -0.25 * since - 0.2 * since * since
                                   : 0.12 * since - 0.2 * since * since;
    return ScenePose{{0.160 + 0.75 * since, 0.012 + gap}, 0.0};
  };
  return scene;
}

// A clip whose frames are stored one upon the other, in groups, and that counts
// how often each is decoded.
class InGroups : public Clip {
 public:
  InGroups(std::unique_ptr<Clip> clip, std::int64_t group,
           std::map<std::int64_t, int>& decoded)
      : clip_(std::move(clip)), group_(group), decoded_(decoded) {}

  const ClipInfo& info() const override { return clip_->info(); }
  std::int64_t EntryFrame(std::int64_t index) const override {
    return index / group_ * group_;
  }

 private:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    if (index < next_ || EntryFrame(index) > next_) next_ = EntryFrame(index);
    for (; next_ <= index; ++next_) ++decoded_[next_];
    return clip_->Read(index, window);
  }

  std::unique_ptr<Clip> clip_;
  std::int64_t group_;
  std::map<std::int64_t, int>& decoded_;
  std::int64_t next_ = 0;
};

}  // namespace touchdown::vision::testing
