// The rendered recordings of ./dev golden: regular cases, each hardship,
// bounces of known height, and one case in each format. Beside each NAME.EXT
// stands NAME.flags: what `analyze` is told of it. Usage:
// touchdown_golden_clips FOLDER
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>

#include "tests/accuracy/design.h"
#include "tests/pipeline/filmed.h"
#include "touchdown/vision/footage/clip_writer.h"
#include "touchdown/vision/synthetic/render.h"

namespace touchdown::accuracy {
namespace {

namespace fs = std::filesystem;

// Frames of a rendered clip, one after the other.
class Film {
 public:
  explicit Film(const Case& c)
      : clip_(vision::OpenScene(pipeline::filmed::BuildScene(c.film), c.seed)) {
  }
  std::optional<core::Frame> operator()() {
    if (frame_ == clip_->info().frames) return std::nullopt;
    return clip_->Read(frame_++);
  }

 private:
  std::shared_ptr<vision::Clip> clip_;
  std::int64_t frame_ = 0;
};

void WriteFlags(const fs::path& folder, const std::string& name,
                const Case& c) {
  std::ofstream flags(folder / (name + ".flags"));
  flags << fmt::format(
      "--fps {} --body {} --scale-px-per-m {}+-{}\n", c.film.camera.fps,
      c.film.thrown.kind == core::BodyKind::kSphere ? "sphere" : "rectangle",
      c.told_px_per_m, kScaleRelativeU * c.told_px_per_m);
}

void WriteRaw(const fs::path& folder, const std::string& name, const Case& c) {
  vision::MrawOptions options;
  options.fps = c.film.camera.fps;
  vision::WriteMraw(folder / (name + ".mraw"), options, Film(c));
  WriteFlags(folder, name, c);
}

void WriteImages(const fs::path& folder, const std::string& name,
                 vision::ImageKind kind, const Case& c) {
  vision::ImageFolderOptions options;
  options.kind = kind;
  vision::WriteImageFolder(folder / name, options, Film(c));
  WriteFlags(folder, name, c);
}

void WriteVideo(const fs::path& folder, const std::string& file,
                vision::VideoCodec codec, const Case& c) {
  vision::VideoOptions options;
  options.codec = codec;
  options.fps = 30.0;  // of playback; the flags tell the film's own
  vision::WriteVideo(folder / file, options, Film(c));
  WriteFlags(folder, fs::path(file).stem(), c);
}

void WriteAll(const fs::path& folder) {
  constexpr std::uint64_t kRegular = 16;
  constexpr std::uint64_t kOfEach = 6;
  constexpr std::uint64_t kRebounds = 6;
  constexpr std::uint64_t kOfFormats = 4;
  for (std::uint64_t i = 0; i < kRegular; ++i) {
    WriteRaw(folder, fmt::format("regular_{}", i), Draw(i, Hardship::kNone));
  }
  for (const Hardship hardship : kHardships) {
    for (std::uint64_t i = 0; i < kOfEach; ++i) {
      std::string name = Name(hardship);
      for (char& letter : name) {
        if (letter == ' ') letter = '_';
      }
      WriteRaw(folder, fmt::format("{}_{}", name, i), Draw(i, hardship));
    }
  }
  for (std::uint64_t i = 0; i < kRebounds; ++i) {
    WriteRaw(folder, fmt::format("rebound_{}", i), DrawRebound(i));
  }
  for (std::uint64_t i = 0; i < kOfFormats; ++i) {
    Case c = Draw(kRegular + i, Hardship::kNone);
    c.film.camera.bit_depth = 8;  // which every format holds
    const auto named = [&](const char* format) {
      return fmt::format("{}_{}", format, i);
    };
    WriteImages(folder, named("png"), vision::ImageKind::kPng, c);
    WriteImages(folder, named("tiff"), vision::ImageKind::kTiff, c);
    WriteImages(folder, named("jpeg"), vision::ImageKind::kJpeg, c);
    WriteVideo(folder, named("mjpeg") + ".avi", vision::VideoCodec::kMjpeg, c);
    WriteVideo(folder, named("h264") + ".mp4", vision::VideoCodec::kH264, c);
    WriteVideo(folder, named("ffv1") + ".avi", vision::VideoCodec::kFfv1, c);
  }
}

}  // namespace
}  // namespace touchdown::accuracy

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: touchdown_golden_clips FOLDER\n", stderr);
    return 2;
  }
  try {
    touchdown::accuracy::WriteAll(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
