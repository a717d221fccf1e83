// TIFF through libtiff.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "footage/formats/image_codecs.h"
#include "footage/formats/tiff_file.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/output_file.h"

namespace touchdown::vision {
namespace {

template <class T>
T Tag(TIFF* tiff, std::uint32_t tag, T fallback) {
  T value{};
  return TIFFGetFieldDefaulted(tiff, tag, &value) == 1 ? value : fallback;
}

// Depth that the words' largest possible value tells, else all 16 bits.
std::int32_t ReadBitDepth(TIFF* tiff) {
  std::uint16_t largest = 0;
  if (TIFFGetField(tiff, TIFFTAG_MAXSAMPLEVALUE, &largest) == 1) {
    for (std::int32_t depth = 9; depth < 16; ++depth) {
      if (largest == (1u << depth) - 1u) return depth;
    }
  }
  return 16;
}

struct RowLayout {
  std::int32_t width_px = 0;
  std::size_t samples_per_pixel = 1;  // alpha included
  bool colour = false;
  bool inverted = false;  // 0 is white
};

template <class Sample>
void ConvertRow(const std::uint8_t* row, const RowLayout& layout,
                std::uint8_t* out) {
  // All bits set.
  constexpr std::uint32_t kWhite = static_cast<Sample>(~Sample{0});
  for (std::int32_t x = 0; x < layout.width_px; ++x) {
    Sample pixel[3] = {};
    std::memcpy(pixel, row, sizeof(Sample) * (layout.colour ? 3 : 1));
    const std::uint32_t gray =
        layout.colour ? Luma(pixel[0], pixel[1], pixel[2]) : pixel[0];
    const auto value =
        static_cast<Sample>(layout.inverted ? kWhite - gray : gray);
    std::memcpy(out, &value, sizeof(Sample));
    row += sizeof(Sample) * layout.samples_per_pixel;
    out += sizeof(Sample);
  }
}

// What the directory that libtiff has read says.
struct Kind {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint16_t bits = 1;
  std::uint16_t samples = 1;
  std::uint16_t meaning = PHOTOMETRIC_MINISBLACK;
  bool gray = true;
  bool tiled = false;

  std::uint32_t pixel_bytes() const { return samples * (bits / 8u); }
};

Kind ReadKind(TIFF* tiff, const std::string& name) {
  Kind kind;
  kind.width = Tag<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH, 0);
  kind.height = Tag<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH, 0);
  kind.bits = Tag<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE, 1);
  kind.samples = Tag<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  kind.meaning =
      Tag<std::uint16_t>(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  kind.gray = kind.meaning == PHOTOMETRIC_MINISBLACK ||
              kind.meaning == PHOTOMETRIC_MINISWHITE;
  kind.tiled = TIFFIsTiled(tiff) != 0;
  const auto format =
      Tag<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
  const auto planar =
      Tag<std::uint16_t>(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  const int least = kind.gray ? 1 : 3;  // one more may be alpha
  if ((kind.bits != 8 && kind.bits != 16) || format != SAMPLEFORMAT_UINT ||
      (!kind.gray && kind.meaning != PHOTOMETRIC_RGB) || kind.samples < least ||
      kind.samples > least + 1 ||
      (kind.samples > 1 && planar != PLANARCONFIG_CONTIG)) {
    throw core::InputError(
        fmt::format("{}: TIFF of {} samples of {} bits (photometric {}, sample "
                    "format {}), expected gray or RGB of 8 or 16 bits",
                    name, kind.samples, kind.bits, kind.meaning, format));
  }
  return kind;
}

// Hands the rows over, from the top; false where libtiff finds them damaged.
template <class Take>
bool EachRow(TIFF* tiff, const Kind& kind, std::size_t file_bytes,
             const Take& take) {
  const std::size_t pixel = kind.pixel_bytes();
  const std::size_t row_bytes = kind.width * pixel;
  if (!kind.tiled) {
    std::vector<std::uint8_t> row(row_bytes);
    if (TIFFScanlineSize64(tiff) != row_bytes) return false;
    for (std::uint32_t y = 0; y < kind.height; ++y) {
      if (TIFFReadScanline(tiff, row.data(), y, 0) != 1) return false;
      take(row.data());
    }
    return true;
  }
  const auto wide = Tag<std::uint32_t>(tiff, TIFFTAG_TILEWIDTH, 0);
  const auto high = Tag<std::uint32_t>(tiff, TIFFTAG_TILELENGTH, 0);
  // px: a tile is at most a picture rounded up; more is a damaged directory.
  constexpr std::uint32_t kMaxTilePx = 1 << 14;
  const std::size_t tile_row = wide * pixel;
  if (wide < 1 || high < 1 || wide > kMaxTilePx || high > kMaxTilePx ||
      static_cast<std::int64_t>(wide) * high > MostPixels(file_bytes) ||
      TIFFTileSize64(tiff) != tile_row * high) {
    return false;
  }
  std::vector<std::uint8_t> tile(tile_row * high);
  std::vector<std::uint8_t> band(row_bytes * std::min(high, kind.height));
  for (std::uint32_t y = 0; y < kind.height; y += high) {
    const std::uint32_t rows = std::min(high, kind.height - y);
    for (std::uint32_t x = 0; x < kind.width; x += wide) {
      if (TIFFReadTile(tiff, tile.data(), x, y, 0, 0) < 0) return false;
      const std::size_t bytes = std::min(wide, kind.width - x) * pixel;
      for (std::uint32_t v = 0; v < rows; ++v) {
        std::memcpy(band.data() + v * row_bytes + x * pixel,
                    tile.data() + v * tile_row, bytes);
      }
    }
    for (std::uint32_t v = 0; v < rows; ++v) take(band.data() + v * row_bytes);
  }
  return true;
}

// The page that libtiff has read the directory of.
void Decode(TIFF* tiff, const TiffMemory& memory, const std::string& name,
            Image& image) {
  const Kind kind = ReadKind(tiff, name);
  Allocate(kind.width, kind.height,
           kind.bits == 8 ? 8
           : kind.gray    ? ReadBitDepth(tiff)
                          : 16,
           memory.input.size(), name, image);
  const RowLayout layout{image.width_px, kind.samples, !kind.gray,
                         kind.meaning == PHOTOMETRIC_MINISWHITE};
  auto* out = reinterpret_cast<std::uint8_t*>(image.pixels.data());
  const bool whole =
      EachRow(tiff, kind, memory.input.size(), [&](const std::uint8_t* row) {
        if (kind.bits == 8) {
          ConvertRow<std::uint8_t>(row, layout, out);
        } else {
          ConvertRow<std::uint16_t>(row, layout, out);
        }
        out += std::size_t{kind.width} * (kind.bits / 8u);
      });
  if (!whole) {
    throw core::InputError(
        fmt::format("{}: damaged TIFF: {}", name, memory.error));
  }
}

}  // namespace

void DecodeTiff(FileBytes file, const std::string& name, Image& image) {
  TiffMemory memory;
  memory.input = file;
  const TiffHandle tiff = OpenTiff(memory, "rm");
  if (!tiff) {
    throw core::InputError(
        fmt::format("{}: damaged TIFF: {}", name, memory.error));
  }
  Decode(tiff.get(), memory, name, image);
}

void DecodeTiffPage(FileBytes file, std::uint64_t directory,
                    const std::string& name, Image& image) {
  TiffMemory memory;
  memory.input = file;
  const TiffHandle tiff = OpenTiff(memory, "rhm");  // h: no directory yet
  if (!tiff || TIFFSetSubDirectory(tiff.get(), directory) != 1) {
    throw core::InputError(
        fmt::format("{}: damaged TIFF: {}", name, memory.error));
  }
  Decode(tiff.get(), memory, name, image);
}

void WriteTiff(const std::filesystem::path& path, const core::Frame& frame) {
  core::OutputFile file(path);
  std::vector<std::uint8_t> bytes;
  TiffMemory memory;
  memory.output = &bytes;
  const auto fail = [&] {
    return core::InputError(
        fmt::format("{}: cannot be written: {}", path.string(), memory.error));
  };
  {
    const TiffHandle tiff = OpenTiff(memory, "wm");
    if (!tiff) throw fail();
    const std::uint16_t bits = frame.is_16_bit() ? 16 : 8;
    TIFFSetField(tiff.get(), TIFFTAG_IMAGEWIDTH, frame.width_px);
    TIFFSetField(tiff.get(), TIFFTAG_IMAGELENGTH, frame.height_px);
    TIFFSetField(tiff.get(), TIFFTAG_BITSPERSAMPLE, bits);
    TIFFSetField(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff.get(), TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff.get(), TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
    TIFFSetField(tiff.get(), TIFFTAG_ZIPQUALITY, 1);
    TIFFSetField(tiff.get(), TIFFTAG_ROWSPERSTRIP,
                 TIFFDefaultStripSize(tiff.get(), 0));
    if (frame.is_16_bit()) {
      TIFFSetField(tiff.get(), TIFFTAG_MAXSAMPLEVALUE, frame.full_scale());
    }
    for (std::int32_t y = 0; y < frame.height_px; ++y) {
      // libtiff takes rows to be read only through a pointer to non-const.
      void* const row = const_cast<std::byte*>(frame.row<std::byte>(y));
      if (TIFFWriteScanline(tiff.get(), row, static_cast<std::uint32_t>(y),
                            0) != 1) {
        throw fail();
      }
    }
    if (TIFFFlush(tiff.get()) != 1) throw fail();
  }
  file.Write({reinterpret_cast<const std::byte*>(bytes.data()), bytes.size()});
  file.Commit();
}

}  // namespace touchdown::vision
