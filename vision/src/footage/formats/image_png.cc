// PNG through libpng. Its errors return by longjmp: the functions that call
// setjmp hold nothing with a destructor.
#include <fmt/format.h>
#include <png.h>
#include <zlib.h>

#include <bit>
#include <csetjmp>
#include <cstring>
#include <functional>
#include <stdexcept>

#include "footage/formats/image_codecs.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/output_file.h"
#include "touchdown/vision/footage/encode_image.h"

namespace touchdown::vision {
namespace {

struct Message {
  char text[160] = "";
};

void OnPngError(png_structp png, png_const_charp text) {
  auto* const message = static_cast<Message*>(png_get_error_ptr(png));
  std::strncpy(message->text, text, sizeof message->text - 1);
  png_longjmp(png, 1);
}

void OnPngWarning(png_structp, png_const_charp) {}

struct Cursor {
  const std::uint8_t* at;
  std::size_t left;
};

void OnPngRead(png_structp png, png_bytep out, std::size_t count) {
  auto* const cursor = static_cast<Cursor*>(png_get_io_ptr(png));
  if (count > cursor->left) png_error(png, "the file ends early");
  std::memcpy(out, cursor->at, count);
  cursor->at += count;
  cursor->left -= count;
}

struct PixelLayout {
  png_uint_32 width = 0;
  png_uint_32 height = 0;
  int channels = 0;  // after the transformations: 1 or 3
  int bits = 0;      // 8 or 16
  int significant_bits = 0;
  int passes = 1;
};

// Reads up to the pixels and asks for 8 or 16 bits, gray or RGB, host order.
bool ReadLayout(png_structp png, png_infop png_info, PixelLayout* layout) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_read_info(png, png_info);
  layout->width = png_get_image_width(png, png_info);
  layout->height = png_get_image_height(png, png_info);
  const int colour = png_get_color_type(png, png_info);
  layout->significant_bits = 16;
  png_color_8p significant = nullptr;
  if (png_get_bit_depth(png, png_info) == 16 && colour == PNG_COLOR_TYPE_GRAY &&
      png_get_sBIT(png, png_info, &significant) != 0 && significant->gray > 8 &&
      significant->gray <= 16) {
    layout->significant_bits = significant->gray;
  }
  if (colour == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png);
  if (colour == PNG_COLOR_TYPE_GRAY && png_get_bit_depth(png, png_info) < 8) {
    png_set_expand_gray_1_2_4_to_8(png);
  }
  png_set_strip_alpha(png);
  if (std::endian::native == std::endian::little) png_set_swap(png);
  layout->passes = png_set_interlace_handling(png);
  png_read_update_info(png, png_info);
  layout->channels = png_get_channels(png, png_info);
  layout->bits = png_get_bit_depth(png, png_info);
  return true;
}

bool ReadPngRows(png_structp png, png_bytep pixels, std::size_t stride,
                 const PixelLayout& layout) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  for (int pass = 0; pass < layout.passes; ++pass) {
    for (png_uint_32 y = 0; y < layout.height; ++y) {
      png_read_row(png, pixels + y * stride, nullptr);
    }
  }
  png_read_end(png, nullptr);  // checks the sum of the last data
  return true;
}

template <class Sample>
void ToLuma(const std::vector<std::uint8_t>& rgb, Image& image) {
  auto* const out = reinterpret_cast<Sample*>(image.pixels.data());
  const auto* const in = reinterpret_cast<const Sample*>(rgb.data());
  const std::size_t count = image.pixels.size() / sizeof(Sample);
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = static_cast<Sample>(Luma(in[3 * i], in[3 * i + 1], in[3 * i + 2]));
  }
}

using Sink = std::function<void(std::span<const std::byte>)>;

struct Writer {
  const Sink* sink;
  std::string* trouble;
};

void OnPngWrite(png_structp png, png_bytep bytes, std::size_t count) {
  auto* const writer = static_cast<Writer*>(png_get_io_ptr(png));
  bool failed = false;
  try {
    (*writer->sink)({reinterpret_cast<const std::byte*>(bytes), count});
  } catch (const core::InputError& error) {
    // No exception may pass through libpng.
    *writer->trouble = error.what();
    failed = true;
  }
  if (failed) png_error(png, "cannot be written");
}

void OnFlush(png_structp) {}

struct Rows {
  const std::uint8_t* first;
  std::ptrdiff_t stride;
  std::int32_t width;
  std::int32_t height;
  std::int32_t bit_depth;
  bool rgb;
};

// Gray in 8 or 16 bits, or RGB. Depths in between are stored scaled, with their
// significant bits (sBIT), so that other programs show them right.
bool WritePngRows(png_structp png, png_infop png_info, const Rows& rows) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  const bool wide = rows.bit_depth > 8;
  png_set_IHDR(png, png_info, static_cast<png_uint_32>(rows.width),
               static_cast<png_uint_32>(rows.height), wide ? 16 : 8,
               rows.rgb ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_BASE,
               PNG_FILTER_TYPE_BASE);
  // Camera noise hardly compresses: the fastest level is as good as any.
  png_set_compression_level(png, 1);
  if (!rows.rgb && !wide) {
    // Nor does it repeat: without filters and searching, a frame of 1280 x 800
    // with noise of 3.5 levels takes 8.4 ms instead of 20, and a fifth less.
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
    png_set_compression_strategy(png, Z_RLE);
  }
  png_color_8 significant{};
  significant.gray = static_cast<png_byte>(rows.bit_depth);
  const bool scaled = wide && rows.bit_depth < 16;
  if (scaled) png_set_sBIT(png, png_info, &significant);
  png_write_info(png, png_info);
  if (scaled) png_set_shift(png, &significant);
  if (wide && std::endian::native == std::endian::little) png_set_swap(png);
  for (std::int32_t y = 0; y < rows.height; ++y) {
    png_write_row(png, rows.first + y * rows.stride);
  }
  png_write_end(png, png_info);
  return true;
}

// `name` stands for the file in messages.
void Encode(const Rows& rows, const std::string& name, const Sink& sink) {
  Message message;
  std::string trouble;
  Writer writer{&sink, &trouble};
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &message,
                                            OnPngError, OnPngWarning);
  if (png == nullptr) throw std::bad_alloc();
  png_infop png_info = png_create_info_struct(png);
  png_set_write_fn(png, &writer, OnPngWrite, OnFlush);
  const bool done = png_info != nullptr && WritePngRows(png, png_info, rows);
  png_destroy_write_struct(&png, &png_info);
  if (!done) {
    throw core::OutputError(
        trouble.empty()
            ? fmt::format("{}: cannot be written: {}", name, message.text)
            : trouble);
  }
}

void Write(const std::filesystem::path& path, const Rows& rows) {
  core::OutputFile file(path);
  Encode(rows, path.string(),
         [&](std::span<const std::byte> bytes) { file.Write(bytes); });
  file.Commit();
}

Rows MakeRows(const core::Frame& frame) {
  return {reinterpret_cast<const std::uint8_t*>(frame.data),
          frame.stride_bytes,
          frame.width_px,
          frame.height_px,
          frame.bit_depth,
          false};
}

}  // namespace

void DecodePng(FileBytes file, const std::string& name, Image& image) {
  Message message;
  const auto fail = [&] {
    return core::InputError(
        fmt::format("{}: damaged PNG: {}", name, message.text));
  };
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &message,
                                           OnPngError, OnPngWarning);
  if (png == nullptr) throw std::bad_alloc();
  png_infop png_info = png_create_info_struct(png);
  struct Guard {
    png_structp* png;
    png_infop* png_info;
    ~Guard() { png_destroy_read_struct(png, png_info, nullptr); }
  } const guard{&png, &png_info};
  if (png_info == nullptr) throw std::bad_alloc();
  Cursor cursor{file.data(), file.size()};
  png_set_read_fn(png, &cursor, OnPngRead);

  PixelLayout layout;
  if (!ReadLayout(png, png_info, &layout)) throw fail();
  Allocate(layout.width, layout.height,
           layout.bits == 16 ? layout.significant_bits : 8, file.size(), name,
           image);
  if (layout.channels == 1) {
    const std::size_t stride =
        std::size_t{layout.width} * (layout.bits == 16 ? 2 : 1);
    if (!ReadPngRows(png, reinterpret_cast<png_bytep>(image.pixels.data()),
                     stride, layout)) {
      throw fail();
    }
    // Undoes the scaling of significant bits.
    if (image.bit_depth > 8 && image.bit_depth < 16) {
      auto* const samples =
          reinterpret_cast<std::uint16_t*>(image.pixels.data());
      const int shift = 16 - image.bit_depth;
      for (std::size_t i = 0; i < image.pixels.size() / 2; ++i) {
        samples[i] = static_cast<std::uint16_t>(samples[i] >> shift);
      }
    }
    return;
  }
  std::vector<std::uint8_t> rgb(3 * image.pixels.size());
  if (!ReadPngRows(png, rgb.data(), rgb.size() / layout.height, layout)) {
    throw fail();
  }
  if (layout.bits == 16) {
    ToLuma<std::uint16_t>(rgb, image);
  } else {
    ToLuma<std::uint8_t>(rgb, image);
  }
}

void WritePng(const std::filesystem::path& path, const core::Frame& frame) {
  Write(path, MakeRows(frame));
}

std::string EncodePng(const core::Frame& frame) {
  std::string file;
  Encode(MakeRows(frame), "a picture", [&](std::span<const std::byte> bytes) {
    file.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  });
  return file;
}

void WritePngRgb(const std::filesystem::path& path, std::int32_t width_px,
                 std::int32_t height_px, std::span<const std::uint8_t> rgb) {
  if (width_px < 1 || height_px < 1 ||
      rgb.size() != std::size_t{3} * static_cast<std::size_t>(width_px) *
                        static_cast<std::size_t>(height_px)) {
    throw std::invalid_argument(
        fmt::format("rgb has {} bytes, must be 3 x {} x {}, sides positive",
                    rgb.size(), width_px, height_px));
  }
  Write(path, {rgb.data(), std::ptrdiff_t{3} * width_px, width_px, height_px, 8,
               true});
}

}  // namespace touchdown::vision
