// JPEG through libjpeg. Its errors return by longjmp: the functions that call
// setjmp hold nothing with a destructor.
#include <fmt/format.h>
#include <jerror.h>
#include <jpeglib.h>

#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "image_codecs.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/output_file.h"
#include "touchdown/vision/encode_image.h"

namespace touchdown::vision {
namespace {

struct Trouble {
  jpeg_error_mgr manager;  // first: libjpeg knows us by its address
  std::jmp_buf back;
  char text[JMSG_LENGTH_MAX];
};

[[noreturn]] void OnJpegError(j_common_ptr jpeg) {
  auto* const trouble = reinterpret_cast<Trouble*>(jpeg->err);
  (*jpeg->err->format_message)(jpeg, trouble->text);
  std::longjmp(trouble->back, 1);
}

// Warnings are silent, but for those that mean lost pixels.
void OnMessage(j_common_ptr jpeg, int level) {
  if (level >= 0) return;
  const int code = jpeg->err->msg_code;
  if (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER ||
      code == JWRN_HUFF_BAD_CODE || code == JWRN_MUST_RESYNC ||
      code == JWRN_NOT_SEQUENTIAL) {
    OnJpegError(jpeg);
  }
}

void OnOutput(j_common_ptr) {}

jpeg_error_mgr* Prepare(Trouble* trouble) {
  jpeg_std_error(&trouble->manager);
  trouble->manager.error_exit = OnJpegError;
  trouble->manager.emit_message = OnMessage;
  trouble->manager.output_message = OnOutput;
  trouble->text[0] = '\0';
  return &trouble->manager;
}

bool ReadHeader(jpeg_decompress_struct* jpeg, Trouble* trouble,
                FileBytes file) {
  if (setjmp(trouble->back) != 0) return false;
  jpeg_create_decompress(jpeg);
  jpeg_mem_src(jpeg, file.data(), static_cast<unsigned long>(file.size()));
  jpeg_read_header(jpeg, TRUE);
  if (jpeg->jpeg_color_space == JCS_CMYK ||
      jpeg->jpeg_color_space == JCS_YCCK) {
    std::strcpy(trouble->text, "CMYK is not read");
    return false;
  }
  // Y of YCbCr is taken as it is; RGB is converted with the same weights.
  jpeg->out_color_space = JCS_GRAYSCALE;
  jpeg->dct_method = JDCT_ISLOW;
  return true;
}

bool ReadJpegRows(jpeg_decompress_struct* jpeg, Trouble* trouble,
                  std::uint8_t* pixels) {
  if (setjmp(trouble->back) != 0) return false;
  jpeg_start_decompress(jpeg);
  while (jpeg->output_scanline < jpeg->output_height) {
    JSAMPROW row = pixels + static_cast<std::size_t>(jpeg->output_scanline) *
                                jpeg->output_width;
    jpeg_read_scanlines(jpeg, &row, 1);
  }
  jpeg_finish_decompress(jpeg);
  return true;
}

bool WriteJpegRows(jpeg_compress_struct* jpeg, Trouble* trouble,
                   const core::Frame& frame, int quality,
                   unsigned char** memory, unsigned long* size) {
  if (setjmp(trouble->back) != 0) return false;
  jpeg_create_compress(jpeg);
  jpeg_mem_dest(jpeg, memory, size);
  jpeg->image_width = static_cast<JDIMENSION>(frame.width_px);
  jpeg->image_height = static_cast<JDIMENSION>(frame.height_px);
  jpeg->input_components = 1;
  jpeg->in_color_space = JCS_GRAYSCALE;
  jpeg_set_defaults(jpeg);
  jpeg_set_quality(jpeg, quality, TRUE);
  jpeg_start_compress(jpeg, TRUE);
  for (std::int32_t y = 0; y < frame.height_px; ++y) {
    // libjpeg takes rows to be read only through a pointer to non-const.
    JSAMPROW row = const_cast<JSAMPROW>(frame.row<JSAMPLE>(y));
    jpeg_write_scanlines(jpeg, &row, 1);
  }
  jpeg_finish_compress(jpeg);
  return true;
}

}  // namespace

void DecodeJpeg(FileBytes file, const std::string& name, Image& image) {
  jpeg_decompress_struct jpeg{};
  Trouble trouble;
  jpeg.err = Prepare(&trouble);
  struct Guard {
    jpeg_decompress_struct* jpeg;
    ~Guard() { jpeg_destroy_decompress(jpeg); }
  } const guard{&jpeg};
  const auto fail = [&] {
    return core::InputError(
        fmt::format("{}: damaged or unsupported JPEG: {}", name, trouble.text));
  };
  if (!ReadHeader(&jpeg, &trouble, file)) throw fail();
  Allocate(jpeg.image_width, jpeg.image_height, 8, file.size(), name, image);
  if (!ReadJpegRows(&jpeg, &trouble,
                    reinterpret_cast<std::uint8_t*>(image.pixels.data()))) {
    throw fail();
  }
}

std::string EncodeJpeg(const core::Frame& frame, int quality) {
  if (frame.bit_depth > 8) {
    throw std::invalid_argument(fmt::format(
        "bit_depth is {}, must be within 1 .. 8 for JPEG", frame.bit_depth));
  }
  if (quality < 1 || quality > 100) {
    throw std::invalid_argument(
        fmt::format("quality is {}, must be within 1 .. 100", quality));
  }
  jpeg_compress_struct jpeg{};
  Trouble trouble;
  jpeg.err = Prepare(&trouble);
  struct Guard {
    jpeg_compress_struct* jpeg;
    unsigned char* memory = nullptr;
    unsigned long size = 0;
    ~Guard() {
      jpeg_destroy_compress(jpeg);
      std::free(memory);
    }
  } guard{&jpeg};
  if (!WriteJpegRows(&jpeg, &trouble, frame, quality, &guard.memory,
                     &guard.size)) {
    throw core::InputError(
        fmt::format("a picture cannot be written as JPEG: {}", trouble.text));
  }
  return {reinterpret_cast<const char*>(guard.memory), guard.size};
}

void WriteJpeg(const std::filesystem::path& path, const core::Frame& frame,
               int quality) {
  core::OutputFile file(path);
  const std::string bytes = EncodeJpeg(frame, quality);
  file.Write(std::as_bytes(std::span(bytes)));
  file.Commit();
}

}  // namespace touchdown::vision
