// A scene as a clip, with no file behind it.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <utility>

#include "touchdown/vision/synthetic/render.h"

namespace touchdown::vision {
namespace {

class SceneClip final : public Clip {
 public:
  SceneClip(Scene scene, std::uint64_t seed)
      : renderer_(std::move(scene)), seed_(seed) {
    const SceneCamera& camera = renderer_.scene().camera;
    info_.path = "scene";
    info_.format = "scene";
    info_.width_px = camera.width_px;
    info_.height_px = camera.height_px;
    info_.bit_depth = camera.bit_depth;
    info_.frames = renderer_.scene().frames;
    info_.time_base.fps = camera.fps;
    info_.time_base.source = FpsSource::kHeader;
    info_.time_base.uniform = true;
    info_.time_base.trusted = true;
  }

  const ClipInfo& info() const override { return info_; }

 protected:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    // The last frame is kept: windows of it cost nothing more.
    if (image_.samples.empty() || image_.index != index) {
      // The seed and the frame's number give the noise: a frame is the same
      // whenever, and in whatever order, it is read.
      const auto i = static_cast<std::uint64_t>(index);
      std::seed_seq seeds{seed_, seed_ >> 32, i, i >> 32};
      std::mt19937_64 engine(seeds);
      image_ = RenderFrame(renderer_, index, engine);
    }
    core::Frame frame = image_.view();
    frame.data +=
        window.y * frame.stride_bytes +
        static_cast<std::ptrdiff_t>(window.x) * (frame.is_16_bit() ? 2 : 1);
    return frame;
  }

 private:
  SceneRenderer renderer_;
  std::uint64_t seed_;
  ClipInfo info_;
  SensorImage image_;
};

}  // namespace

std::unique_ptr<Clip> OpenScene(Scene scene, std::uint64_t seed) {
  return std::make_unique<SceneClip>(std::move(scene), seed);
}

}  // namespace touchdown::vision
