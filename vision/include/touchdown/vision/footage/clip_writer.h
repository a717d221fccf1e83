// Recordings written: what the scene renderer and tests feed the readers with.
//
// Every writer takes its frames one by one from a function, so that memory does
// not grow with the clip, and gives the finished clip its name only at the end:
// a clip under its name is complete. Sizes and depth are those of the first
// frame; all must be alike. `time_s`, `index` and origin of the frames are not
// looked at.
//
// All throw core::InputError naming the output if it cannot be written (no such
// folder, disk full), and std::invalid_argument if there is no frame, a frame
// is unlike the first, or an option does not fit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "touchdown/core/frame.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

// The next frame, or nothing at the end. Its pixels need to live only until the
// next call.
using FrameSource = std::function<std::optional<core::Frame>()>;

// How .mraw stores samples. k12Packed needs frames of 12 bits; k16 of 9 to 16
// (right-aligned: EffectiveBit Side Lower); k8 of 8.
enum class MrawBits { k8, k12Packed, k16 };

struct MrawOptions {
  double fps = 1000.0;  // of the frames written: Record Rate / Save Step
  std::int64_t save_step = 1;
  std::int64_t start_frame = 0;
  std::optional<MrawBits> bits =
      std::nullopt;        // default: by the frames' depth, 12 packed
  bool xml_header = true;  // .cihx, else .cih
  std::optional<SensorOrigin> sensor_origin = std::nullopt;  // .cihx only
};

// Writes `path` (.mraw) and its header beside it, replacing a recording of that
// name with either form of header. Returns the number of frames.
std::int64_t WriteMraw(const std::filesystem::path& path,
                       const MrawOptions& options, const FrameSource& next);

enum class ImageKind { kPng, kTiff, kJpeg };

struct ImageFolderOptions {
  ImageKind kind = ImageKind::kPng;
  std::string prefix = "frame_";  // of the names: frame_000000.png
  int jpeg_quality = 95;
};

// Writes a new folder of images. A folder that exists and is not empty is left
// as it is and refused with core::InputError. Returns the number of frames.
std::int64_t WriteImageFolder(const std::filesystem::path& folder,
                              const ImageFolderOptions& options,
                              const FrameSource& next);

// kMjpeg and kH264 are lossy and of 8 bits (H.264 at quality 0 is lossless);
// kFfv1 is lossless, of 8, 10, 12 or 16 bits; kRaw is uncompressed, of 8 bits
// in .avi and .mkv and of 16 in .avi. Samples are written as full-range luma.
enum class VideoCodec { kMjpeg, kH264, kFfv1, kRaw };

struct VideoOptions {
  VideoCodec codec = VideoCodec::kFfv1;
  double fps = 1000.0;  // at most 1000 in .avi and .mkv
  // Quantiser: kMjpeg 1 (best) to 31, kH264 0 (lossless) to 51. At the default
  // of 2 (MJPEG) or 18 (H.264) loss is below the noise of a camera.
  std::optional<int> quality = std::nullopt;
  // Distance of key frames in H.264; short ones make reading backwards fast.
  int key_frame_distance = 50;
  int turn_quarters = 0;  // display rotation, quarter turns anticlockwise
};

// Writes a video; the container follows from the extension: .avi, .mp4, .mov or
// .mkv. Returns the number of frames. H.264 needs a libavcodec built with
// libx264 (Debian's is); core::InputError says so if it is not.
std::int64_t WriteVideo(const std::filesystem::path& path,
                        const VideoOptions& options, const FrameSource& next);

}  // namespace touchdown::vision
