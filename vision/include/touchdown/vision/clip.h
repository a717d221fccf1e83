// Clips: one recording of one shot, whatever its container.
//
//   auto clip = OpenClip("shot_017.mraw");
//   for (int64_t i = 0; i < clip->info().frames; ++i) {
//     core::Frame frame = clip->Read(i);
//     ...
//   }
//
// Formats: video through libav (avi, mp4, mkv, mov, cine: MJPEG, H.264, FFV1,
// raw; 8 to 16 bit; gray and colour, of which the luma is read), Photron
// .mraw with its .cih or .cihx beside it (8, 12 packed, 16 bit), folders of
// PNG, TIFF or JPEG (8 and 16 bit) in natural order of their names.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "touchdown/core/frame.h"

namespace touchdown::vision {

// Where the frame rate comes from.
enum class FpsSource { kHeader, kContainer, kUser };
std::string_view Name(FpsSource source);  // "header", "container", "user"

struct TimeBase {
  double fps = 0.0;  // frames per second of the recording (not of playback)
  FpsSource source = FpsSource::kContainer;
  bool uniform = true;   // frames equally spaced in time
  bool trusted = false;  // false: a playback rate may have been mistaken for it
};

struct ClipInfo {
  std::filesystem::path path;
  std::string format;  // "mraw", "avi", "mp4", "png-folder", ...
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  std::int32_t bit_depth = 8;           // significant bits of a sample, 1..16
  std::int64_t frames = 0;              // that can be read
  std::int64_t first_camera_frame = 0;  // the camera's own number of frame 0
  TimeBase time_base;
  std::vector<std::string> warnings;  // one sentence each, for the user
};

struct ClipOptions {
  // Recorded frame rate, in frames per second; overrides the file's.
  std::optional<double> fps;
};

// An open recording. Not safe to share between threads.
class Clip {
 public:
  virtual ~Clip() = default;
  Clip() = default;
  Clip(const Clip&) = delete;
  Clip& operator=(const Clip&) = delete;

  virtual const ClipInfo& info() const = 0;

  // A view of `window` of frame `index`, valid until the next Read of this
  // clip. The default window is the whole picture; raw formats touch only the
  // bytes of the window. Reading in order is fast in every format; reading
  // backwards in a compressed one starts over from the nearest key frame.
  //
  // Throws std::invalid_argument if `index` or `window` lies outside the clip,
  // core::InputError (file, frame) if the frame's data are damaged or missing.
  core::Frame Read(std::int64_t index);
  core::Frame Read(std::int64_t index, const core::PixelRect& window);

 protected:
  virtual core::Frame ReadWindow(std::int64_t index,
                                 const core::PixelRect& window) = 0;
};

// Opens a recording: a video file, an .mraw (or its .cih/.cihx), or a folder of
// images. Throws core::InputError naming the file, and what to do, if it does
// not exist, is damaged before its first frame, or is of an unknown kind;
// std::invalid_argument if options.fps is not positive and finite.
std::unique_ptr<Clip> OpenClip(const std::filesystem::path& path,
                               const ClipOptions& options = {});

}  // namespace touchdown::vision
