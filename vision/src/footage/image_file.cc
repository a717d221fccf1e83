#include "touchdown/vision/footage/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "footage/formats/clip_formats.h"
#include "footage/formats/image_codecs.h"
#include "footage/formats/mapped_file.h"
#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

// Pixels: a damaged header cannot make us allocate more than 512 MiB.
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;
// Pixels that a byte of a file can stand for: Deflate (PNG, TIFF) makes at most
// 1032 bytes of one, a JPEG of one gray 4 bits for each 64 pixels and
// component; LZW comes to 2700. More is a header that lies, and is found out
// before a byte is allocated. Pictures of the size of a thumbnail are always
// allowed.
constexpr std::int64_t kMaxPixelsPerByte = 4096;
constexpr std::int64_t kAlwaysAllowedPixels = 1 << 16;

bool StartsWith(FileBytes file, std::initializer_list<std::uint8_t> magic) {
  return file.size() >= magic.size() &&
         std::equal(magic.begin(), magic.end(), file.begin());
}

}  // namespace

core::Frame Image::View() const {
  core::Frame frame;
  frame.data = pixels.data();
  frame.width_px = width_px;
  frame.height_px = height_px;
  frame.bit_depth = bit_depth;
  frame.stride_bytes = std::ptrdiff_t{width_px} * (bit_depth > 8 ? 2 : 1);
  return frame;
}

bool IsImageName(const std::filesystem::path& path) {
  const std::string extension = LowerExtension(path);
  return extension == ".png" || extension == ".tif" || extension == ".tiff" ||
         extension == ".jpg" || extension == ".jpeg";
}

// Largest number of pixels that a file of this size can hold.
std::int64_t MostPixels(std::size_t file_bytes) {
  // Beyond it kMaxPixels decides; the product below does not overflow.
  constexpr std::int64_t kMaxBytes = kMaxPixels / kMaxPixelsPerByte;
  return kAlwaysAllowedPixels +
         kMaxPixelsPerByte *
             std::min(static_cast<std::int64_t>(file_bytes), kMaxBytes);
}

void Allocate(std::int64_t width_px, std::int64_t height_px,
              std::int32_t bit_depth, std::size_t file_bytes,
              const std::string& name, Image& image) {
  if (width_px < 1 || height_px < 1 || width_px > kMaxSidePx ||
      height_px > kMaxSidePx || width_px * height_px > kMaxPixels) {
    throw core::InputError(fmt::format(
        "{}: {}x{} pixels, expected 1 .. {} a side and at most {} in all", name,
        width_px, height_px, kMaxSidePx, kMaxPixels));
  }
  if (width_px * height_px > MostPixels(file_bytes)) {
    throw core::InputError(fmt::format(
        "{}: says that it is {}x{} pixels, more than its {} bytes can hold; it "
        "is damaged, or cut off",
        name, width_px, height_px, file_bytes));
  }
  image.width_px = static_cast<std::int32_t>(width_px);
  image.height_px = static_cast<std::int32_t>(height_px);
  image.bit_depth = bit_depth;
  image.pixels.resize(static_cast<std::size_t>(width_px * height_px) *
                      (bit_depth > 8 ? 2 : 1));
}

void ReadImage(const std::filesystem::path& path, Image& image) {
  const MappedFile map(path);
  const FileBytes file(reinterpret_cast<const std::uint8_t*>(map.data()),
                       static_cast<std::size_t>(map.size_bytes()));
  const std::string name = path.string();
  // The content decides, not the name.
  if (StartsWith(file, {0x89, 'P', 'N', 'G'})) {
    DecodePng(file, name, image);
  } else if (StartsWith(file, {0xFF, 0xD8, 0xFF})) {
    DecodeJpeg(file, name, image);
  } else if (StartsWith(file, {'I', 'I', 42, 0}) ||
             StartsWith(file, {'M', 'M', 0, 42}) ||
             StartsWith(file, {'I', 'I', 43, 0}) ||
             StartsWith(file, {'M', 'M', 0, 43})) {
    DecodeTiff(file, name, image);
  } else {
    throw core::InputError(fmt::format(
        "{}: {}", name,
        file.empty() ? "is empty, expected PNG, TIFF or JPEG"
                     : "not a PNG, TIFF or JPEG picture, whatever its name"));
  }
  map.RequireWhole();
}

Image ReadImage(const std::filesystem::path& path) {
  Image image;
  ReadImage(path, image);
  return image;
}

}  // namespace touchdown::vision
