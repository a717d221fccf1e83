#include "app/measure/undistorted_clip.h"

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "app/measure/open_recording.h"
#include "touchdown/vision/background/steady_camera.h"
#include "touchdown/vision/contact/lens_track.h"

namespace touchdown::pipeline {
namespace {

// Bilinear; 0 where one of the four neighbours lies outside of the frame.
double InterpolateLevel(const core::Frame& frame, core::PixelPoint p) {
  const double x0 = std::floor(p.x_px);
  const double y0 = std::floor(p.y_px);
  if (!(x0 >= 0.0) || !(y0 >= 0.0) || !(x0 + 1.0 < frame.width_px) ||
      !(y0 + 1.0 < frame.height_px)) {
    return 0.0;
  }
  const auto x = static_cast<std::int32_t>(x0);
  const auto y = static_cast<std::int32_t>(y0);
  const double a = p.x_px - x0;
  const double b = p.y_px - y0;
  return (1.0 - b) * ((1.0 - a) * frame.at(x, y) + a * frame.at(x + 1, y)) +
         b * ((1.0 - a) * frame.at(x, y + 1) + a * frame.at(x + 1, y + 1));
}

// Each frame is read whole: a window of the result needs a bent window of the
// source, and people look at one frame at a time.
class Straightened final : public vision::Clip {
 public:
  Straightened(std::unique_ptr<vision::Clip> clip, const calib::Lens& lens)
      : clip_(std::move(clip)), lens_(lens) {
    set_cancellation(clip_->cancellation());
  }

  const vision::ClipInfo& info() const override { return clip_->info(); }

 protected:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    core::Frame frame = clip_->Read(index);
    const std::size_t bytes = frame.is_16_bit() ? 2 : 1;
    samples_.resize(bytes * static_cast<std::size_t>(window.width) *
                    static_cast<std::size_t>(window.height));
    std::size_t i = 0;
    for (std::int32_t y = window.y; y < window.y + window.height; ++y) {
      for (std::int32_t x = window.x; x < window.x + window.width; ++x, ++i) {
        const double level = InterpolateLevel(
            frame, calib::Distort(lens_, {static_cast<double>(x),
                                          static_cast<double>(y)}));
        const auto sample = static_cast<std::uint16_t>(std::lround(level));
        if (bytes == 2) {
          reinterpret_cast<std::uint16_t*>(samples_.data())[i] = sample;
        } else {
          samples_[i] = static_cast<std::byte>(sample);
        }
      }
    }
    frame.data = samples_.data();
    frame.stride_bytes = static_cast<std::ptrdiff_t>(bytes) * window.width;
    return frame;
  }

 private:
  std::unique_ptr<vision::Clip> clip_;
  calib::Lens lens_;
  std::vector<std::byte> samples_;
};

}  // namespace

std::unique_ptr<vision::Clip> UndistortedClip(
    std::unique_ptr<vision::Clip> clip, const calib::Lens& lens) {
  return std::make_unique<Straightened>(std::move(clip), lens);
}

std::optional<std::pair<std::int64_t, std::int64_t>> SteadyFrames(
    const Analysis& analysis) {
  if (!analysis.camera_moved_px) return std::nullopt;
  const std::int64_t last = analysis.options.last_frame;
  return std::pair(analysis.options.first_frame,
                   last < 0 ? analysis.clip.frames : last);
}

Drawable OpenToDraw(const Analysis& analysis) {
  vision::ClipOptions options;
  // A rate that the user gave numbers the frames of the document.
  options.fps = analysis.options.fps;
  Drawable out{OpenRecording(analysis.clip.path, options), *analysis.track};
  if (const auto steady = SteadyFrames(analysis)) {
    const vision::CameraMotion motion =
        vision::MeasureCameraMotion(*out.clip, steady->first, steady->second);
    out.clip = vision::PutBack(std::move(out.clip), motion);
  }
  if (analysis.calibration && analysis.calibration->lens) {
    const calib::Lens& lens = analysis.calibration->lens->lens;
    out.clip = UndistortedClip(std::move(out.clip), lens);
    out.track = vision::Undistorted(out.track, lens);
  }
  return out;
}

}  // namespace touchdown::pipeline
