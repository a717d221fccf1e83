// TIFF through libtiff, with message handlers of the open file only (the
// library's global ones stay as they are).
#include <fmt/format.h>
#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "image_codecs.h"
#include "output_file.h"
#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

// A file in memory: to be read, or growing.
struct Memory {
  FileBytes input;
  std::vector<std::uint8_t>* output = nullptr;
  std::uint64_t at = 0;
  char error[160] = "";

  std::uint64_t size() const { return output ? output->size() : input.size(); }
};

int OnError(TIFF*, void* user, const char*, const char* format, va_list args) {
  auto* const memory = static_cast<Memory*>(user);
  // The first message is the cause; later ones follow from it.
  if (memory->error[0] == '\0') {
    std::vsnprintf(memory->error, sizeof memory->error, format, args);
  }
  return 1;
}

int OnWarning(TIFF*, void*, const char*, const char*, va_list) { return 1; }

tmsize_t OnRead(thandle_t handle, void* out, tmsize_t count) {
  auto* const memory = static_cast<Memory*>(handle);
  if (count <= 0 || memory->at >= memory->size()) return 0;
  const auto got = std::min<std::uint64_t>(static_cast<std::uint64_t>(count),
                                           memory->size() - memory->at);
  const std::uint8_t* const from =
      memory->output ? memory->output->data() : memory->input.data();
  std::memcpy(out, from + memory->at, got);
  memory->at += got;
  return static_cast<tmsize_t>(got);
}

tmsize_t OnWrite(thandle_t handle, void* bytes, tmsize_t count) {
  auto* const memory = static_cast<Memory*>(handle);
  if (memory->output == nullptr || count < 0) return 0;
  const std::uint64_t end = memory->at + static_cast<std::uint64_t>(count);
  if (end > memory->output->size()) memory->output->resize(end);
  std::memcpy(memory->output->data() + memory->at, bytes,
              static_cast<std::size_t>(count));
  memory->at = end;
  return count;
}

toff_t OnSeek(thandle_t handle, toff_t offset, int whence) {
  auto* const memory = static_cast<Memory*>(handle);
  if (whence == SEEK_CUR) offset += memory->at;
  if (whence == SEEK_END) offset += memory->size();
  memory->at = offset;
  return offset;
}

int OnClose(thandle_t) { return 0; }

toff_t OnSize(thandle_t handle) {
  return static_cast<const Memory*>(handle)->size();
}

struct Close {
  void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};
using TiffHandle = std::unique_ptr<TIFF, Close>;

TiffHandle Open(Memory& memory, const char* mode) {
  TIFFOpenOptions* const options = TIFFOpenOptionsAlloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options, OnError, &memory);
  TIFFOpenOptionsSetWarningHandlerExtR(options, OnWarning, &memory);
  TIFF* const tiff =
      TIFFClientOpenExt("", mode, &memory, OnRead, OnWrite, OnSeek, OnClose,
                        OnSize, nullptr, nullptr, options);
  TIFFOpenOptionsFree(options);
  return TiffHandle(tiff);
}

template <class T>
T Tag(TIFF* tiff, std::uint32_t tag, T fallback) {
  T value{};
  return TIFFGetFieldDefaulted(tiff, tag, &value) == 1 ? value : fallback;
}

// Depth that the words' largest possible value tells, else all 16 bits.
std::int32_t DepthOf(TIFF* tiff) {
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
void TakeRow(const std::uint8_t* row, const RowLayout& layout,
             std::uint8_t* out) {
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

}  // namespace

void DecodeTiff(FileBytes file, const std::string& name, Image& image) {
  Memory memory;
  memory.input = file;
  const auto fail = [&](const std::string& why) {
    return core::InputError(fmt::format("{}: {}", name, why));
  };
  const auto damaged = [&] {
    return fail(fmt::format("damaged TIFF: {}", memory.error));
  };
  const TiffHandle tiff = Open(memory, "rm");
  if (!tiff) throw damaged();

  const auto width = Tag<std::uint32_t>(tiff.get(), TIFFTAG_IMAGEWIDTH, 0);
  const auto height = Tag<std::uint32_t>(tiff.get(), TIFFTAG_IMAGELENGTH, 0);
  const auto bits = Tag<std::uint16_t>(tiff.get(), TIFFTAG_BITSPERSAMPLE, 1);
  const auto samples =
      Tag<std::uint16_t>(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, 1);
  const auto format =
      Tag<std::uint16_t>(tiff.get(), TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
  const auto planar =
      Tag<std::uint16_t>(tiff.get(), TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  const auto meaning = Tag<std::uint16_t>(tiff.get(), TIFFTAG_PHOTOMETRIC,
                                          PHOTOMETRIC_MINISBLACK);
  const bool gray =
      meaning == PHOTOMETRIC_MINISBLACK || meaning == PHOTOMETRIC_MINISWHITE;
  if ((bits != 8 && bits != 16) || format != SAMPLEFORMAT_UINT ||
      (!gray && meaning != PHOTOMETRIC_RGB) || (gray && samples > 2) ||
      (!gray && (samples < 3 || samples > 4)) ||
      (samples > 1 && planar != PLANARCONFIG_CONTIG) ||
      TIFFIsTiled(tiff.get()) != 0) {
    throw fail(fmt::format(
        "TIFF of {} samples of {} bits{} (photometric {}), expected gray or "
        "RGB of 8 or 16 bits in strips",
        samples, bits, TIFFIsTiled(tiff.get()) != 0 ? " in tiles" : "",
        meaning));
  }
  Allocate(width, height,
           bits == 8 ? 8
           : gray    ? DepthOf(tiff.get())
                     : 16,
           name, image);
  const auto row_bytes = TIFFScanlineSize64(tiff.get());
  const std::uint64_t needed = std::uint64_t{width} * samples * (bits / 8);
  if (row_bytes != needed) throw damaged();
  std::vector<std::uint8_t> row(needed);
  const RowLayout layout{image.width_px, samples, !gray,
                         meaning == PHOTOMETRIC_MINISWHITE};
  auto* out = reinterpret_cast<std::uint8_t*>(image.pixels.data());
  for (std::uint32_t y = 0; y < height; ++y) {
    if (TIFFReadScanline(tiff.get(), row.data(), y, 0) != 1) throw damaged();
    if (bits == 8) {
      TakeRow<std::uint8_t>(row.data(), layout, out);
    } else {
      TakeRow<std::uint16_t>(row.data(), layout, out);
    }
    out += std::size_t{width} * (bits / 8);
  }
}

void WriteTiff(const std::filesystem::path& path, const core::Frame& frame) {
  OutputFile file(path);
  std::vector<std::uint8_t> bytes;
  Memory memory;
  memory.output = &bytes;
  const auto fail = [&] {
    return core::InputError(
        fmt::format("{}: cannot be written: {}", path.string(), memory.error));
  };
  {
    const TiffHandle tiff = Open(memory, "wm");
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
