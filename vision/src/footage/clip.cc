#include "touchdown/vision/footage/clip.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <system_error>

#include "footage/formats/clip_formats.h"
#include "touchdown/core/errors.h"
#include "touchdown/vision/footage/image_file.h"

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

std::string LowerExtension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(
      extension.begin(), extension.end(), extension.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
      });
  return extension;
}

std::string_view Name(Channel channel) {
  switch (channel) {
    case Channel::kLuma:
      return "luma";
    case Channel::kBlueDifference:
      return "blue difference (Cb)";
    case Channel::kRedDifference:
      return "red difference (Cr)";
  }
  return "?";
}

core::Frame Clip::Read(std::int64_t index) {
  return Read(index, {0, 0, info().width_px, info().height_px});
}

// Checks the arguments once for all formats, and fills in what all frames have.
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
  const auto start = std::chrono::steady_clock::now();
  cancellation_.Check(index, start);
  core::Frame frame = ReadWindow(index, window);
  frame.width_px = window.width;
  frame.height_px = window.height;
  frame.origin_x_px = window.x;
  frame.origin_y_px = window.y;
  frame.index = index;
  reading_s_ +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
          .count();
  return frame;
}

std::unique_ptr<Clip> Clip::OpenAnother() const {
  std::unique_ptr<Clip> another = Another();
  if (another) another->set_cancellation(cancellation_);
  return another;
}

// Everything but .mraw is decoded by libraries, and is read by a process apart.
bool IsForeign(const std::filesystem::path& path) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  return std::filesystem::is_directory(status) ||
         (std::filesystem::is_regular_file(status) && !IsMrawOrHeader(path));
}

std::unique_ptr<Clip> OpenClip(const std::filesystem::path& path,
                               const ClipOptions& options) {
  return OpenClipInMemory(path, options, nullptr);
}

// Chooses the reader by what the path is and how its name ends; each reader
// then checks the content.
std::unique_ptr<Clip> OpenClipInMemory(const std::filesystem::path& path,
                                       const ClipOptions& options,
                                       FrameMemory* memory) {
  if (options.fps && !(std::isfinite(*options.fps) && *options.fps > 0.0)) {
    throw std::invalid_argument(fmt::format(
        "fps is {}, must be positive and finite (frames per second)",
        *options.fps));
  }
  if (options.decoder_threads < 0) {
    throw std::invalid_argument(
        fmt::format("decoder_threads is {}, must be 0 (one for each core) or "
                    "more",
                    options.decoder_threads));
  }
  std::error_code trouble;
  const auto status = std::filesystem::status(path, trouble);
  if (!std::filesystem::exists(status)) {
    throw core::InputError(
        trouble && trouble != std::errc::no_such_file_or_directory
            ? fmt::format("{}: {}", path.string(), trouble.message())
            : fmt::format("{}: no such file or folder", path.string()));
  }
  const bool folder = std::filesystem::is_directory(status);
  if (!folder && !std::filesystem::is_regular_file(status)) {
    throw core::InputError(
        fmt::format("{}: neither a file nor a folder", path.string()));
  }
  if (options.channel != Channel::kLuma &&
      (folder || IsMrawOrHeader(path) || IsImageName(path))) {
    throw std::invalid_argument(
        fmt::format("channel is {}, but {} is read as gray",
                    Name(options.channel), path.string()));
  }
  if (folder) return OpenImageFolder(path, options);
  if (IsMrawOrHeader(path)) return OpenMraw(path, options);
  if (IsTiffStack(path)) return OpenTiffStack(path, options);
  if (IsImageName(path)) {
    throw core::InputError(
        fmt::format("{}: a single picture is no recording; give the folder "
                    "that holds its pictures",
                    path.string()));
  }
  return OpenVideo(path, options, memory);
}

}  // namespace touchdown::vision
