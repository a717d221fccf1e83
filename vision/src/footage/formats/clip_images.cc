// A folder of images as a clip.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <system_error>

#include "footage/formats/clip_formats.h"
#include "footage/formats/natural_order.h"
#include "touchdown/core/errors.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::vision {
namespace {

// "png", "tiff" or "jpeg".
std::string FileKind(const std::filesystem::path& path) {
  const std::string extension = LowerExtension(path);
  if (extension == ".png") return "png";
  return extension.starts_with(".t") ? "tiff" : "jpeg";
}

// The last number in a file's name, if it fits: img_0012.png -> 12.
std::optional<std::int64_t> FileNumber(const std::filesystem::path& path) {
  constexpr std::string_view kDigits = "0123456789";  // in any locale
  const std::string stem = path.stem().string();
  const auto last = stem.find_last_of(kDigits);
  if (last == std::string::npos) return std::nullopt;
  const auto before = stem.find_last_not_of(kDigits, last);
  const std::size_t first = before == std::string::npos ? 0 : before + 1;
  std::int64_t number = 0;
  const auto [end, error] =
      std::from_chars(stem.data() + first, stem.data() + last + 1, number);
  return error == std::errc{} ? std::optional(number) : std::nullopt;
}

// A folder of pictures. One of them is held in memory; going back decodes
// again.
class ImageFolderClip final : public Clip {
 public:
  ImageFolderClip(const std::filesystem::path& folder,
                  const ClipOptions& options)
      : files_(ListImages(folder)) {
    if (!options.fps) {
      throw core::InputError(fmt::format(
          "{}: a folder of images has no frame rate; give the camera's with "
          "--fps",
          folder.string()));
    }
    RefuseStack(0);
    Load(0);
    info_.path = folder;
    info_.format = FileKind(files_.front()) + "-folder";
    info_.width_px = image_.width_px;
    info_.height_px = image_.height_px;
    info_.bit_depth = image_.bit_depth;
    info_.frames = static_cast<std::int64_t>(files_.size());
    info_.time_base = {*options.fps, FpsSource::kUser, true, true};
    WarnOfGaps();
  }

  explicit ImageFolderClip(const ImageFolderClip& like)
      : files_(like.files_), info_(like.info_) {}

  const ClipInfo& info() const override { return info_; }
  std::unique_ptr<Clip> Another() const override {
    return std::make_unique<ImageFolderClip>(*this);
  }

 protected:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    if (index != loaded_) {
      RefuseStack(index);
      Load(index);
      CheckLikeFirst(index);
    }
    core::Frame frame = image_.View();
    frame.data += window.y * frame.stride_bytes +
                  std::ptrdiff_t{window.x} * (frame.is_16_bit() ? 2 : 1);
    frame.time_s = static_cast<double>(index) / info_.time_base.fps;
    return frame;
  }

 private:
  // A picture a file: of a TIFF with several pages all but one would be lost.
  void RefuseStack(std::int64_t index) const {
    const auto& file = files_[static_cast<std::size_t>(index)];
    if (!IsTiffStack(file)) return;
    throw core::InputError(fmt::format(
        "{} (frame {}): a TIFF of several pages, expected a picture a file in "
        "a folder of images; give the path of that file to read its pages",
        file.string(), index));
  }

  void Load(std::int64_t index) {
    loaded_ = -1;  // until it is done
    try {
      ReadImage(files_[static_cast<std::size_t>(index)], image_);
    } catch (const core::InputError& error) {
      throw core::InputError(fmt::format("{} (frame {})", error.what(), index));
    }
    loaded_ = index;
  }

  void CheckLikeFirst(std::int64_t index) {
    if (image_.width_px == info_.width_px &&
        image_.height_px == info_.height_px &&
        image_.bit_depth == info_.bit_depth) {
      return;
    }
    loaded_ = -1;
    throw core::InputError(fmt::format(
        "{} (frame {}): {}x{} at {} bits, expected {}x{} at {} bits like {}",
        files_[static_cast<std::size_t>(index)].string(), index,
        image_.width_px, image_.height_px, image_.bit_depth, info_.width_px,
        info_.height_px, info_.bit_depth, files_.front().filename().string()));
  }

  // Frames that are missing would count as if no time had passed.
  void WarnOfGaps() {
    for (std::size_t i = 1; i < files_.size(); ++i) {
      const auto before = FileNumber(files_[i - 1]);
      const auto after = FileNumber(files_[i]);
      if (!before || !after || *after == *before + 1) continue;
      info_.warnings.push_back(fmt::format(
          "the numbers of the images are not consecutive ({} is followed by "
          "{}): they are taken as equally spaced in time all the same",
          files_[i - 1].filename().string(), files_[i].filename().string()));
      return;
    }
  }

  std::vector<std::filesystem::path> files_;
  ClipInfo info_;
  Image image_;
  std::int64_t loaded_ = -1;  // the frame that image_ holds
};

}  // namespace

std::vector<std::filesystem::path> ListImages(
    const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code trouble;
  std::filesystem::directory_iterator entry(folder, trouble);
  for (; !trouble && entry != std::filesystem::directory_iterator();
       entry.increment(trouble)) {
    const std::filesystem::path& path = entry->path();
    std::error_code ignored;
    if (IsImageName(path) && !path.filename().string().starts_with('.') &&
        !entry->is_directory(ignored)) {
      files.push_back(path);
    }
  }
  if (trouble) {
    throw core::InputError(
        fmt::format("{}: {}", folder.string(), trouble.message()));
  }
  if (files.empty()) {
    throw core::InputError(fmt::format(
        "{}: no PNG, TIFF or JPEG in this folder", folder.string()));
  }
  // In the order of the numbers in their names: img_9 before img_10.
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) {
    return NaturalLess(a.filename().string(), b.filename().string());
  });
  const std::string kind = FileKind(files.front());
  for (const auto& file : files) {
    if (FileKind(file) == kind) continue;
    throw core::InputError(fmt::format(
        "{}: images of two kinds ({} and {}), expected those of one recording "
        "alone",
        folder.string(), files.front().filename().string(),
        file.filename().string()));
  }
  return files;
}

std::unique_ptr<Clip> OpenImageFolder(const std::filesystem::path& folder,
                                      const ClipOptions& options) {
  return std::make_unique<ImageFolderClip>(folder, options);
}

}  // namespace touchdown::vision
