#include <fmt/format.h>

#include <system_error>

#include "footage/writers/frame_feed.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/output_file.h"
#include "touchdown/vision/footage/clip_writer.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::vision {

std::int64_t WriteImageFolder(const std::filesystem::path& folder,
                              const ImageFolderOptions& options,
                              const FrameSource& next) {
  // Without the slash that a user may have typed after the name.
  const std::filesystem::path target =
      folder.has_filename() ? folder : folder.parent_path();
  std::error_code trouble;
  if (std::filesystem::exists(target, trouble) &&
      !(std::filesystem::is_directory(target, trouble) &&
        std::filesystem::is_empty(target, trouble))) {
    throw core::OutputError(
        fmt::format("{}: exists already; name a new folder or empty this one",
                    target.string()));
  }
  // Written under another name and renamed when complete: an interrupted writer
  // leaves no folder that looks whole.
  core::TemporaryName name(target);
  std::filesystem::create_directory(name.path(), trouble);
  if (trouble) {
    throw core::OutputError(fmt::format("{}: cannot be written: {}",
                                        target.string(), trouble.message()));
  }
  FrameFeed feed(next);
  while (const auto frame = feed.Next()) {
    const auto file = [&](const char* extension) {
      return name.path() / fmt::format("{}{:06}{}", options.prefix,
                                       feed.count() - 1, extension);
    };
    switch (options.kind) {
      case ImageKind::kPng:
        WritePng(file(".png"), *frame);
        break;
      case ImageKind::kTiff:
        WriteTiff(file(".tif"), *frame);
        break;
      case ImageKind::kJpeg:
        WriteJpeg(file(".jpg"), *frame, options.jpeg_quality);
        break;
    }
  }
  name.Commit();
  return feed.count();
}

}  // namespace touchdown::vision
