#include "footage/formats/frame_buffers.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace touchdown::vision {
namespace {

// Planes that libav's picture functions handle.
constexpr std::size_t kPlanes = 4;
// Bytes beyond a plane: decoders may write a vector's width beyond its end.
constexpr std::size_t kSpareBytes = 128;

struct PlaneLayout {
  std::array<int, kPlanes> row_bytes{};
  std::array<std::size_t, kPlanes> bytes{};  // 0: there is no such plane
};

// The planes of a frame as the decoder wants them aligned; false where it is
// none that is laid out plainly.
bool LayOut(AVCodecContext& decoder, const AVFrame& frame,
            PlaneLayout& layout) {
  const auto format = static_cast<AVPixelFormat>(frame.format);
  const AVPixFmtDescriptor* const about = Libav().av_pix_fmt_desc_get(format);
  // Formats whose planes are no rows of samples.
  constexpr std::uint64_t kOtherwise =
      AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_BITSTREAM;
  if (about == nullptr || (about->flags & kOtherwise) != 0) return false;
  int width = frame.width;
  int height = frame.height;
  std::array<int, AV_NUM_DATA_POINTERS> align{};
  Libav().avcodec_align_dimensions2(&decoder, &width, &height, align.data());
  for (bool aligned = false; !aligned; width += width & -width) {
    if (Libav().av_image_fill_linesizes(layout.row_bytes.data(), format,
                                        width) < 0) {
      return false;
    }
    aligned = true;
    for (std::size_t i = 0; i < kPlanes; ++i) {
      if (align[i] > 0 && layout.row_bytes[i] % align[i] != 0) aligned = false;
    }
  }
  std::array<std::ptrdiff_t, kPlanes> rows{};
  std::copy(layout.row_bytes.begin(), layout.row_bytes.end(), rows.begin());
  return Libav().av_image_fill_plane_sizes(layout.bytes.data(), format, height,
                                           rows.data()) >= 0;
}

void GiveBack(void* memory, std::uint8_t* data) {
  static_cast<FrameMemory*>(memory)->Give(reinterpret_cast<std::byte*>(data));
}

std::size_t Padded(std::size_t bytes) {
  // Bytes: what the widest vector instructions want.
  constexpr std::size_t kAlign = 64;
  return (bytes + kSpareBytes + kAlign - 1) / kAlign * kAlign;
}

// libav's get_buffer2, called from its threads.
int TakeFrame(AVCodecContext* decoder, AVFrame* frame, int flags) {
  auto* const memory = static_cast<FrameMemory*>(decoder->opaque);
  PlaneLayout layout;
  std::size_t total = 0;
  std::byte* piece = nullptr;
  if (LayOut(*decoder, *frame, layout)) {
    for (const std::size_t bytes : layout.bytes) {
      total += bytes > 0 ? Padded(bytes) : 0;
    }
    piece = memory->Take(total);
  }
  if (piece == nullptr) {
    memory->Beat();
    return Libav().avcodec_default_get_buffer2(decoder, frame, flags);
  }
  auto* at = reinterpret_cast<std::uint8_t*>(piece);
  frame->buf[0] = Libav().av_buffer_create(at, total, GiveBack, memory, 0);
  if (frame->buf[0] == nullptr) {
    memory->Give(piece);
    return AVERROR(ENOMEM);
  }
  for (std::size_t i = 0; i < kPlanes; ++i) {
    if (layout.bytes[i] == 0) continue;
    frame->data[i] = at;
    frame->linesize[i] = layout.row_bytes[i];
    at += Padded(layout.bytes[i]);
  }
  frame->extended_data = frame->data;
  return 0;
}

}  // namespace

void UseFrameMemory(FrameMemory& memory, AVCodecContext& decoder) {
  if (decoder.codec == nullptr ||
      (decoder.codec->capabilities & AV_CODEC_CAP_DR1) == 0) {
    return;
  }
  decoder.opaque = &memory;
  decoder.get_buffer2 = TakeFrame;
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
  // Without it libav 5.1 decodes with one thread at a time.
  decoder.thread_safe_callbacks = 1;
#pragma GCC diagnostic pop
}

}  // namespace touchdown::vision
