// libav with owners, and its error codes as words.
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/crc.h>
#include <libavutil/display.h>
#include <libavutil/imgutils.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>
}

#include <memory>
#include <string>

namespace touchdown::vision {

// What we call of libavformat, libavcodec and libavutil. They bring a hundred
// libraries with them, half of the start-up of a command that needs no video,
// so they are not linked but loaded when the first video is opened.
struct LibavFunctions {
  // Throws core::InputError where a library is not installed, or is of another
  // version than was compiled for.
  LibavFunctions();

// NOLINTNEXTLINE(bugprone-macro-parentheses): it declares
#define TOUCHDOWN_LIBAV_FUNCTION(name) decltype(&::name) name = nullptr;
#include "footage/formats/libav_functions.inc"
#undef TOUCHDOWN_LIBAV_FUNCTION
};
const LibavFunctions& Libav();

struct LibavDelete {
  void operator()(AVFormatContext* c) const {
    Libav().avformat_close_input(&c);
  }
  void operator()(AVCodecContext* c) const { Libav().avcodec_free_context(&c); }
  void operator()(AVFrame* f) const { Libav().av_frame_free(&f); }
  void operator()(AVPacket* p) const { Libav().av_packet_free(&p); }
  void operator()(AVDictionary* d) const { Libav().av_dict_free(&d); }
};
template <class T>
using LibavPtr = std::unique_ptr<T, LibavDelete>;

inline std::string LibavError(int code) {
  char text[AV_ERROR_MAX_STRING_SIZE] = "";
  Libav().av_strerror(code, text, sizeof text);
  return text;
}

}  // namespace touchdown::vision
