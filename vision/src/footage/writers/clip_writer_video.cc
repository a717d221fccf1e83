extern "C" {
#include <libavutil/display.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>
}

#include <fmt/format.h>

#include <cstring>
#include <string_view>

#include "footage/formats/clip_formats.h"
#include "footage/formats/libav.h"
#include "footage/writers/frame_feed.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/output_file.h"
#include "touchdown/vision/footage/clip_writer.h"

namespace touchdown::vision {
namespace {

struct MuxerDelete {
  void operator()(AVFormatContext* context) const {
    if (context->pb != nullptr) Libav().avio_closep(&context->pb);
    Libav().avformat_free_context(context);
  }
};

const char* ChooseContainer(const std::filesystem::path& path) {
  const std::string extension = LowerExtension(path);
  if (extension == ".avi") return "avi";
  if (extension == ".mp4") return "mp4";
  if (extension == ".mov") return "mov";
  if (extension == ".mkv") return "matroska";
  throw std::invalid_argument(fmt::format(
      "path is {}, must end in .avi, .mp4, .mov or .mkv", path.string()));
}

struct CodecChoice {
  const char* encoder;
  int worst_quality;
  int default_quality;
};

CodecChoice ChooseEncoder(VideoCodec codec) {
  switch (codec) {
    case VideoCodec::kMjpeg:
      return {"mjpeg", 31, 2};
    case VideoCodec::kH264:
      return {"libx264", 51, 18};
    case VideoCodec::kFfv1:
      return {"ffv1", 0, 0};
    case VideoCodec::kRaw:
      return {"rawvideo", 0, 0};
  }
  return {"", 0, 0};
}

// Lossy codecs take 8 bits with empty colour planes; lossless ones gray as it
// is.
AVPixelFormat ChoosePixelFormat(VideoCodec codec, std::int32_t bit_depth) {
  const bool lossy = codec == VideoCodec::kMjpeg || codec == VideoCodec::kH264;
  if (lossy && bit_depth == 8) return AV_PIX_FMT_YUVJ420P;
  if (!lossy) {
    switch (bit_depth) {
      case 8:
        return AV_PIX_FMT_GRAY8;
      case 10:
        if (codec == VideoCodec::kFfv1) return AV_PIX_FMT_GRAY10LE;
        break;
      case 12:
        if (codec == VideoCodec::kFfv1) return AV_PIX_FMT_GRAY12LE;
        break;
      case 16:
        return AV_PIX_FMT_GRAY16LE;
      default:
        break;
    }
  }
  throw std::invalid_argument(fmt::format(
      "bit_depth of the frames is {}, must be 8 for MJPEG and H.264, 8 or 16 "
      "for raw video, 8, 10, 12 or 16 for FFV1",
      bit_depth));
}

// Encodes frame by frame; the file gets its name when it is complete.
class VideoWriter {
 public:
  VideoWriter(const std::filesystem::path& path, const VideoOptions& options)
      : container_(ChooseContainer(path)),
        options_(options),
        name_(path),
        packet_(Libav().av_packet_alloc()),
        picture_(Libav().av_frame_alloc()) {
    CheckFps(options.fps);
    // Frames per second: libav writes faster ones as 600 fps in .avi, and to
    // the nearest millisecond in .mkv.
    constexpr double kMaxCoarseFps = 1000.0;
    const std::string_view container = container_;
    if ((container == "avi" || container == "matroska") &&
        options.fps > kMaxCoarseFps) {
      throw std::invalid_argument(fmt::format(
          "fps is {}, must be at most {} in .avi and .mkv; take .mp4 or .mov",
          options.fps, kMaxCoarseFps));
    }
    const CodecChoice choice = ChooseEncoder(options.codec);
    if (options.quality &&
        (*options.quality < 0 || *options.quality > choice.worst_quality)) {
      throw std::invalid_argument(
          fmt::format("quality is {}, must be within 0 .. {} for {}",
                      *options.quality, choice.worst_quality, choice.encoder));
    }
    if (options.key_frame_distance < 1) {
      throw std::invalid_argument(
          fmt::format("key_frame_distance is {}, must be 1 or more frames",
                      options.key_frame_distance));
    }
  }

  void Add(const core::Frame& frame, std::int64_t index) {
    if (index == 0) Start(frame);
    Check(Libav().av_frame_make_writable(picture_.get()));
    const auto row_bytes =
        static_cast<std::size_t>(frame.width_px) * (frame.is_16_bit() ? 2 : 1);
    for (std::int32_t y = 0; y < frame.height_px; ++y) {
      std::memcpy(picture_->data[0] + std::ptrdiff_t{y} * picture_->linesize[0],
                  frame.row<std::byte>(y), row_bytes);
    }
    for (const int plane : {1, 2}) {
      if (picture_->data[plane] == nullptr) continue;
      // Cb and Cr of gray.
      constexpr int kNoColour = 128;
      std::memset(picture_->data[plane], kNoColour,
                  static_cast<std::size_t>(picture_->linesize[plane]) *
                      static_cast<std::size_t>((frame.height_px + 1) / 2));
    }
    picture_->pts = index;
    Check(Libav().avcodec_send_frame(codec_.get(), picture_.get()));
    Drain();
  }

  void Finish() {
    Check(Libav().avcodec_send_frame(codec_.get(), nullptr));
    Drain();
    Check(Libav().av_write_trailer(format_.get()));
    const int failed = format_->pb->error;
    const int closed = Libav().avio_closep(&format_->pb);
    Check(failed);
    Check(closed);
    name_.Commit();
  }

 private:
  void Check(int code) const {
    if (code >= 0) return;
    throw core::OutputError(fmt::format("{}: cannot be written: {}",
                                        name_.target().string(),
                                        LibavError(code)));
  }

  void Start(const core::Frame& frame) {
    const CodecChoice choice = ChooseEncoder(options_.codec);
    const AVPixelFormat pixels =
        ChoosePixelFormat(options_.codec, frame.bit_depth);
    const AVCodec* const codec =
        Libav().avcodec_find_encoder_by_name(choice.encoder);
    if (codec == nullptr) {
      throw core::InputError(fmt::format(
          "{}: cannot be written: this libavcodec has no encoder {}",
          name_.target().string(), choice.encoder));
    }
    AVFormatContext* format = nullptr;
    Check(Libav().avformat_alloc_output_context2(&format, nullptr, container_,
                                                 nullptr));
    format_.reset(format);
    if (Libav().avformat_query_codec(format->oformat, codec->id,
                                     FF_COMPLIANCE_NORMAL) == 0) {
      throw std::invalid_argument(
          fmt::format("codec is {}, which a {} file cannot hold; take .avi or "
                      ".mkv",
                      choice.encoder, container_));
    }
    codec_.reset(Libav().avcodec_alloc_context3(codec));
    codec_->width = frame.width_px;
    codec_->height = frame.height_px;
    codec_->pix_fmt = pixels;
    codec_->color_range = AVCOL_RANGE_JPEG;
    // 2^20: exact for every rate of whole and of thousandths of frames.
    codec_->framerate = Libav().av_d2q(options_.fps, 1 << 20);
    codec_->time_base = av_inv_q(codec_->framerate);
    codec_->sample_aspect_ratio = {1, 1};
    codec_->thread_count = 0;  // as many as there are cores
    const int quality = options_.quality.value_or(choice.default_quality);
    if (options_.codec == VideoCodec::kMjpeg) {
      codec_->flags |= AV_CODEC_FLAG_QSCALE;
      codec_->global_quality = FF_QP2LAMBDA * std::max(quality, 1);
      picture_->quality = codec_->global_quality;
    } else if (options_.codec == VideoCodec::kH264) {
      codec_->gop_size = options_.key_frame_distance;
      Libav().av_opt_set(codec_->priv_data, "preset", "veryfast", 0);
      Libav().av_opt_set_int(codec_->priv_data, "qp", quality, 0);
    } else if (options_.codec == VideoCodec::kFfv1) {
      codec_->level = 3;     // slices with check sums
      codec_->gop_size = 1;  // a damaged frame does not spoil the next
      Libav().av_opt_set_int(codec_->priv_data, "slicecrc", 1, 0);
    }
    if ((format_->oformat->flags & AVFMT_GLOBALHEADER) != 0) {
      codec_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    }
    Check(Libav().avcodec_open2(codec_.get(), codec, nullptr));

    picture_->format = pixels;
    picture_->width = frame.width_px;
    picture_->height = frame.height_px;
    Check(Libav().av_frame_get_buffer(picture_.get(), 0));

    stream_ = Libav().avformat_new_stream(format_.get(), nullptr);
    if (stream_ == nullptr) Check(AVERROR(ENOMEM));
    Check(Libav().avcodec_parameters_from_context(stream_->codecpar,
                                                  codec_.get()));
    stream_->time_base = codec_->time_base;
    stream_->avg_frame_rate = codec_->framerate;
    if (options_.turn_quarters % 4 != 0) {
      auto* const matrix =
          reinterpret_cast<std::int32_t*>(Libav().av_stream_new_side_data(
              stream_, AV_PKT_DATA_DISPLAYMATRIX, 9 * sizeof(std::int32_t)));
      if (matrix == nullptr) Check(AVERROR(ENOMEM));
      Libav().av_display_rotation_set(matrix, -90.0 * options_.turn_quarters);
    }
    // Made by us, so that it is new and no link; libav then writes into it.
    close(name_.MakeFile());
    Check(Libav().avio_open(&format_->pb,
                            ("file:" + name_.path().string()).c_str(),
                            AVIO_FLAG_WRITE));
    if (options_.codec == VideoCodec::kRaw && frame.bit_depth == 16 &&
        std::string_view(container_) != "avi") {
      throw std::invalid_argument(
          "bit_depth of the frames is 16, must be 8 for raw video in .mkv; "
          "take "
          ".avi");
    }
    Check(Libav().avformat_init_output(format_.get(), nullptr));
    if (options_.codec == VideoCodec::kRaw && frame.bit_depth == 16) {
      // Initialising clears the tag by which readers know 16-bit gray.
      stream_->codecpar->codec_tag = MKTAG('Y', '1', '6', ' ');
    }
    Check(Libav().avformat_write_header(format_.get(), nullptr));
  }

  void Drain() {
    for (;;) {
      const int got =
          Libav().avcodec_receive_packet(codec_.get(), packet_.get());
      if (got == AVERROR(EAGAIN) || got == AVERROR_EOF) return;
      Check(got);
      packet_->stream_index = stream_->index;
      packet_->duration = 1;
      Libav().av_packet_rescale_ts(packet_.get(), codec_->time_base,
                                   stream_->time_base);
      Check(Libav().av_interleaved_write_frame(format_.get(), packet_.get()));
      Check(format_->pb->error);
    }
  }

  const char* container_;
  VideoOptions options_;
  core::TemporaryName
      name_;  // before format_: the file is closed, then removed
  std::unique_ptr<AVFormatContext, MuxerDelete> format_;
  LibavPtr<AVCodecContext> codec_;
  LibavPtr<AVPacket> packet_;
  LibavPtr<AVFrame> picture_;
  AVStream* stream_ = nullptr;  // of format_
};

}  // namespace

std::int64_t WriteVideo(const std::filesystem::path& path,
                        const VideoOptions& options, const FrameSource& next) {
  // libav's log is of the whole program; its complaints come to us as codes.
  Libav().av_log_set_level(AV_LOG_QUIET);
  VideoWriter writer(path, options);
  FrameFeed feed(next);
  while (const auto frame = feed.Next()) writer.Add(*frame, feed.count() - 1);
  writer.Finish();
  return feed.count();
}

}  // namespace touchdown::vision
