// What the tests of video files share: small lossless videos, and their packets
// copied with a change.
#pragma once

extern "C" {
#include <libavformat/avformat.h>
}

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

#include "tests/vision/clip_helpers.h"
#include "touchdown/vision/footage/clip_writer.h"

namespace touchdown::vision {

inline constexpr std::int32_t kWidth = 48;
inline constexpr std::int32_t kHeight = 32;

inline Image Plain(std::int64_t i) { return Pattern(kWidth, kHeight, 8, i); }

inline void WritePlain(const std::filesystem::path& path, std::int64_t frames,
                       VideoOptions options,
                       const std::function<Image(std::int64_t)>& make = Plain) {
  std::int64_t i = 0;
  Image image;
  WriteVideo(path, options, [&]() -> std::optional<core::Frame> {
    if (i == frames) return std::nullopt;
    image = make(i++);
    return image.View();
  });
}

inline VideoOptions Lossless(VideoCodec codec, double fps = 500.0) {
  VideoOptions options;
  options.codec = codec;
  options.fps = fps;
  if (codec == VideoCodec::kH264) options.quality = 0;
  options.key_frame_distance = 10;
  return options;
}

// Copies the packets of a video into another file after `change` of each.
inline void Remux(const std::filesystem::path& from,
                  const std::filesystem::path& to,
                  const std::function<void(AVPacket&)>& change) {
  AVFormatContext* in = nullptr;
  ASSERT_EQ(avformat_open_input(&in, from.c_str(), nullptr, nullptr), 0);
  ASSERT_GE(avformat_find_stream_info(in, nullptr), 0);
  AVFormatContext* out = nullptr;
  ASSERT_GE(avformat_alloc_output_context2(&out, nullptr, nullptr, to.c_str()),
            0);
  AVStream* const stream = avformat_new_stream(out, nullptr);
  avcodec_parameters_copy(stream->codecpar, in->streams[0]->codecpar);
  stream->codecpar->codec_tag = 0;
  stream->time_base = in->streams[0]->time_base;
  ASSERT_GE(avio_open(&out->pb, to.c_str(), AVIO_FLAG_WRITE), 0);
  ASSERT_GE(avformat_write_header(out, nullptr), 0);
  AVPacket* packet = av_packet_alloc();
  while (av_read_frame(in, packet) >= 0) {
    change(*packet);
    av_packet_rescale_ts(packet, in->streams[0]->time_base, stream->time_base);
    packet->pos = -1;
    ASSERT_EQ(av_interleaved_write_frame(out, packet), 0);
  }
  ASSERT_EQ(av_write_trailer(out), 0);
  av_packet_free(&packet);
  avio_closep(&out->pb);
  avformat_free_context(out);
  avformat_close_input(&in);
}

}  // namespace touchdown::vision
