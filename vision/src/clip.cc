#include "touchdown/vision/clip.h"

#include <fmt/format.h>

#include <stdexcept>

namespace touchdown::vision {

std::string_view Name(FpsSource source) {
  switch (source) {
    case FpsSource::kHeader:
      return "header";
    case FpsSource::kContainer:
      return "container";
    case FpsSource::kUser:
      return "user";
  }
  return "?";
}

core::Frame Clip::Read(std::int64_t index) {
  return Read(index, {0, 0, info().width_px, info().height_px});
}

core::Frame Clip::Read(std::int64_t index, const core::PixelRect& window) {
  const ClipInfo& clip = info();
  if (index < 0 || index >= clip.frames) {
    throw std::invalid_argument(fmt::format(
        "frame is {}, must be within 0 .. {}", index, clip.frames - 1));
  }
  if (window.x < 0 || window.y < 0 || window.width < 1 || window.height < 1 ||
      window.width > clip.width_px - window.x ||
      window.height > clip.height_px - window.y) {
    throw std::invalid_argument(fmt::format(
        "window is {},{},{},{}, must lie within the {}x{} picture", window.x,
        window.y, window.width, window.height, clip.width_px, clip.height_px));
  }
  return ReadWindow(index, window);
}

}  // namespace touchdown::vision
