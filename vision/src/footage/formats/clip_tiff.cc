// A TIFF of several pages as a clip: a page a frame. The directories are listed
// once, when the file is opened; a page is then read by where its directory
// stands. Pages that are not compressed are views of the mapped file, or copied
// from the window only where their bytes must be turned around.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <system_error>

#include "footage/formats/clip_formats.h"
#include "footage/formats/mapped_file.h"
#include "footage/formats/tiff_file.h"
#include "footage/formats/tiff_pages.h"
#include "touchdown/core/errors.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::vision {
namespace {

static_assert(std::endian::native == std::endian::little,
              "samples of little-endian files are handed out in place");

FileBytes ToFileBytes(const MappedFile& file) {
  return {reinterpret_cast<const std::uint8_t*>(file.data()),
          static_cast<std::size_t>(file.size_bytes())};
}

std::string Geometry(const TiffPage& page) {
  return fmt::format("{}x{} at {} bits", page.width_px, page.height_px,
                     page.bit_depth);
}

// One page a frame. Plain pages (one uncompressed piece of gray samples) are
// read in place; others are decoded one by one.
class TiffStackClip final : public Clip {
 public:
  TiffStackClip(const std::filesystem::path& path, const ClipOptions& options)
      : file_(std::make_shared<const MappedFile>(path)),
        list_(std::make_shared<const TiffPages>(
            ListTiffPages(ToFileBytes(*file_), path.string()))) {
    info_.path = path;
    info_.format = "tiff-stack";
    if (pages().empty()) {
      Fail(list_->ended_early.empty()
               ? "there is no picture in it"
               : "there is no whole picture in it: " + list_->ended_early);
    }
    if (!options.fps) {
      Fail("a TIFF stack has no frame rate; give the camera's with --fps");
    }
    CheckAlike();
    info_.width_px = static_cast<std::int32_t>(pages()[0].width_px);
    info_.height_px = static_cast<std::int32_t>(pages()[0].height_px);
    info_.bit_depth = pages()[0].bit_depth;
    info_.frames = static_cast<std::int64_t>(pages().size());
    info_.time_base = {*options.fps, FpsSource::kUser, true, true};
    swapped_ = info_.bit_depth > 8 && list_->big_endian;
    plain_ = std::all_of(pages().begin(), pages().end(),
                         [](const TiffPage& page) { return page.samples > 0; });
    // Words at odd bytes cannot be handed out in place.
    in_place_ =
        plain_ && !swapped_ &&
        std::all_of(pages().begin(), pages().end(), [&](const TiffPage& page) {
          return info_.bit_depth <= 8 || page.samples % 2 == 0;
        });
    if (!list_->ended_early.empty()) {
      info_.warnings.push_back(fmt::format(
          "{} ends early ({}): {} frames are there", path.filename().string(),
          list_->ended_early, info_.frames));
    }
    if (list_->thumbnails > 0) {
      info_.warnings.push_back(
          fmt::format("{} pages of reduced size are left out (thumbnails)",
                      list_->thumbnails));
    }
  }

  // Decodes the first page where that takes a decoder.
  void LoadFirst() {
    if (!plain_) Load(0);
  }

  // Reads what `like` reads.
  explicit TiffStackClip(const TiffStackClip* like)
      : file_(like->file_),
        list_(like->list_),
        info_(like->info_),
        plain_(like->plain_),
        in_place_(like->in_place_),
        swapped_(like->swapped_) {}

  const ClipInfo& info() const override { return info_; }
  bool views_last() const override { return in_place_; }
  bool windows_are_cheap() const override { return plain_; }
  std::unique_ptr<Clip> Another() const override {
    return std::make_unique<TiffStackClip>(this);
  }

  void WillRead(std::int64_t index, const core::PixelRect& window) override {
    if (!plain_) return;
    const auto begin = static_cast<std::int64_t>(page(index).samples);
    file_->WillRead(begin + window.y * row_bytes(),
                    begin + (window.y + window.height) * row_bytes());
  }
  void HasRead() const override { file_->HasRead(); }
  void RequireWhole() const override { file_->RequireWhole(); }

 protected:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    file_->RequireNothingLost();
    core::Frame frame;
    if (plain_) {
      frame = InFile(index, window);
    } else {
      if (index != loaded_) Load(index);
      frame = image_.View();
      frame.data += window.y * frame.stride_bytes + window.x * sample_bytes();
    }
    frame.bit_depth = info_.bit_depth;
    frame.time_s = static_cast<double>(index) / info_.time_base.fps;
    return frame;
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const {
    throw core::InputError(fmt::format("{}: {}", info_.path.string(), what));
  }

  const std::vector<TiffPage>& pages() const { return list_->pages; }
  const TiffPage& page(std::int64_t index) const {
    return pages()[static_cast<std::size_t>(index)];
  }
  std::ptrdiff_t sample_bytes() const { return info_.bit_depth > 8 ? 2 : 1; }
  std::ptrdiff_t row_bytes() const { return info_.width_px * sample_bytes(); }

  // The first page's own size is checked by its decoder, or here.
  void CheckAlike() const {
    const TiffPage& first = pages()[0];
    if (first.width_px < 1 || first.width_px > kMaxSidePx ||
        first.height_px < 1 || first.height_px > kMaxSidePx) {
      Fail(fmt::format("{}x{} pixels, expected 1 .. {} a side", first.width_px,
                       first.height_px, kMaxSidePx));
    }
    if (first.bit_depth < 8 || first.bit_depth > 16) {
      Fail(fmt::format("{} bits a sample, expected 8 or 16", first.bit_depth));
    }
    for (std::size_t i = 1; i < pages().size(); ++i) {
      const TiffPage& other = pages()[i];
      if (other.width_px == first.width_px &&
          other.height_px == first.height_px &&
          other.bit_depth == first.bit_depth) {
        continue;
      }
      Fail(
          fmt::format("page {} (frame {}) is {}, expected {} like the first "
                      "page; save the recording's pages alone",
                      i + 1, i, Geometry(other), Geometry(first)));
    }
  }

  void Load(std::int64_t index) {
    loaded_ = -1;  // until it is done
    try {
      DecodeTiffPage(ToFileBytes(*file_), page(index).directory,
                     info_.path.string(), image_);
    } catch (const core::InputError& error) {
      throw core::InputError(fmt::format("{} (frame {})", error.what(), index));
    }
    if (image_.width_px != info_.width_px ||
        image_.height_px != info_.height_px ||
        image_.bit_depth != info_.bit_depth) {
      Fail(fmt::format("frame {} is damaged: its directory is ambiguous",
                       index));
    }
    loaded_ = index;
  }

  core::Frame InFile(std::int64_t index, const core::PixelRect& window) {
    core::Frame frame;
    const std::byte* const first = file_->data() + page(index).samples +
                                   window.y * row_bytes() +
                                   window.x * sample_bytes();
    if (in_place_) {
      frame.data = first;
      frame.stride_bytes = row_bytes();
      return frame;
    }
    const auto width = static_cast<std::size_t>(window.width);
    words_.resize(width * static_cast<std::size_t>(window.height));
    std::uint16_t* out = words_.data();
    for (std::int32_t y = 0; y < window.height; ++y, out += width) {
      std::memcpy(out, first + y * row_bytes(), 2 * width);
      if (!swapped_) continue;
      std::transform(out, out + width, out, [](std::uint16_t v) {
        return static_cast<std::uint16_t>(v << 8 | v >> 8);
      });
    }
    frame.data = reinterpret_cast<const std::byte*>(words_.data());
    frame.stride_bytes = std::ptrdiff_t{2} * window.width;
    return frame;
  }

  std::shared_ptr<const MappedFile> file_;
  std::shared_ptr<const TiffPages> list_;
  ClipInfo info_;
  bool plain_ = false;     // no page needs a decoder
  bool in_place_ = false;  // and samples lie in the file as a Frame has them
  bool swapped_ = false;   // its words are big-endian
  Image image_;
  std::int64_t loaded_ = -1;  // the frame that image_ holds
  std::vector<std::uint16_t> words_;
};

}  // namespace

bool IsTiffStack(const std::filesystem::path& path) {
  const std::string extension = LowerExtension(path);
  if (extension != ".tif" && extension != ".tiff") return false;
  const MappedFile file(path);
  return HasSeveralTiffPages(ToFileBytes(file));
}

std::unique_ptr<Clip> OpenTiffStack(const std::filesystem::path& path,
                                    const ClipOptions& options) {
  auto clip = std::make_unique<TiffStackClip>(path, options);
  clip->LoadFirst();
  return clip;
}

std::unique_ptr<Clip> OpenPlainTiffStack(const std::filesystem::path& path,
                                         const ClipOptions& options) {
  std::error_code ignored;
  if (options.channel != Channel::kLuma ||
      !std::filesystem::is_regular_file(path, ignored) || !IsTiffStack(path)) {
    return nullptr;
  }
  auto clip = std::make_unique<TiffStackClip>(path, options);
  if (!clip->windows_are_cheap()) return nullptr;
  return clip;
}

}  // namespace touchdown::vision
