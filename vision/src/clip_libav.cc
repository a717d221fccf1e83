// Video files as clips. A frame's number never comes from a container's seek:
// all packets are listed when the file is opened, the frame that the decoder
// returns is known by its timestamp in that list (or by counting from the
// beginning), and after a seek the first packet must be one of the list, else
// the file is opened again and decoded from its beginning.
extern "C" {
#include <libavutil/pixdesc.h>
}

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "clip_formats.h"
#include "libav.h"
#include "luma.h"
#include "touchdown/core/errors.h"
#include "video_index.h"

namespace touchdown::vision {
namespace {

// Containers that hold one recording in one file. Play lists and the like,
// which make libav open other files, are not among them.
constexpr char kContainers[] =
    "avi,mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,cine,mpegts,mpeg,asf,flv,ogg,"
    "nut,gif,yuv4mpegpipe,ivf,h264,hevc,m4v,mjpeg,apng,mxf,dv";

class VideoClip final : public Clip {
 public:
  VideoClip(const std::filesystem::path& path, const ClipOptions& options)
      : path_(path),
        threads_(options.decoder_threads > 0
                     ? options.decoder_threads
                     : static_cast<std::int32_t>(
                           std::max(1u, std::thread::hardware_concurrency()))),
        packet_(av_packet_alloc()),
        frame_(av_frame_alloc()) {
    info_.path = path;
    Open();
    info_.format = FormatName();
    index_ = IndexVideo(*format_, *stream_, declared_rate_);
    if (index_.frames < 1) {
      Fail(index_.ended_early.empty()
               ? "there is no whole frame in it"
               : "there is no whole frame in it: " + index_.ended_early);
    }
    info_.frames = index_.frames;
    if (!index_.ended_early.empty()) {
      info_.warnings.push_back(fmt::format(
          "{} ends early ({}): {} frames are there", path_.filename().string(),
          index_.ended_early, index_.frames));
    }
    StartFrom(0);
    DecodeUpTo(0);
    LookAtFirstFrame();
    SetTimeBase(options);
  }

  const ClipInfo& info() const override { return info_; }

 protected:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    if (index != current_) {
      if (index < current_ || current_ < 0) {
        StartFrom(index);
      } else if (index > current_ + threads_ && !index_.pts.empty() &&
                 index_.KeyPacketFor(index) >
                     sent_ + static_cast<std::size_t>(threads_)) {
        // Skipping saves more decoding than it throws away.
        StartFrom(index);
      }
      DecodeUpTo(index);
    }
    if (frame_->width != stored_width_ || frame_->height != stored_height_ ||
        frame_->format != reader_->format()) {
      Fail(
          fmt::format("frame {} is of another size or pixel format than the "
                      "first",
                      index));
    }
    core::Frame view = reader_->View(*frame_, window);
    view.index = index;
    view.time_s = TimeOf(index);
    return view;
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const {
    throw core::InputError(fmt::format("{}: {}", path_.string(), what));
  }

  void Open() {
    codec_.reset();
    format_.reset();
    AVDictionary* options = nullptr;
    av_dict_set(&options, "format_whitelist", kContainers, 0);
    av_dict_set(&options, "protocol_whitelist", "file", 0);
    AVFormatContext* format = nullptr;
    // The prefix keeps a name like "http:a.avi" a name.
    const int opened = avformat_open_input(
        &format, ("file:" + path_.string()).c_str(), nullptr, &options);
    av_dict_free(&options);
    format_.reset(format);
    if (opened < 0) {
      Fail(
          fmt::format("not a recording that can be read ({}); expected a "
                      "video, an .mraw with its header, or a folder of images",
                      LibavError(opened)));
    }
    // What the container itself says, before it is overridden by guesses.
    std::vector<AVRational> declared;
    for (unsigned i = 0; i < format_->nb_streams; ++i) {
      declared.push_back(format_->streams[i]->avg_frame_rate);
    }
    if (const int found = avformat_find_stream_info(format_.get(), nullptr);
        found < 0) {
      Fail(fmt::format("damaged before its first frame ({})",
                       LibavError(found)));
    }
    stream_ = nullptr;
    const int best = av_find_best_stream(format_.get(), AVMEDIA_TYPE_VIDEO, -1,
                                         -1, nullptr, 0);
    for (unsigned i = 0; i < format_->nb_streams; ++i) {
      AVStream* const stream = format_->streams[i];
      if (static_cast<int>(i) == best &&
          (stream->disposition & AV_DISPOSITION_ATTACHED_PIC) == 0) {
        stream_ = stream;
        declared_rate_ = i < declared.size() ? declared[i] : AVRational{0, 1};
      } else {
        stream->discard = AVDISCARD_ALL;  // sound, subtitles, cover pictures
      }
    }
    if (stream_ == nullptr) Fail("there is no video in it");
    if (stream_->codecpar->codec_id == AV_CODEC_ID_NONE &&
        stream_->codecpar->codec_tag == MKTAG('Y', '1', '6', ' ')) {
      // 16-bit gray of machine-vision cameras, which libav does not know in
      // .avi.
      stream_->codecpar->codec_id = AV_CODEC_ID_RAWVIDEO;
      stream_->codecpar->codec_tag =
          avcodec_pix_fmt_to_codec_tag(AV_PIX_FMT_GRAY16LE);
    }
    OpenDecoder();
  }

  void OpenDecoder() {
    const AVCodecParameters& parameters = *stream_->codecpar;
    const AVCodec* const codec = avcodec_find_decoder(parameters.codec_id);
    if (codec == nullptr) {
      Fail(fmt::format("there is no decoder for its video ({})",
                       avcodec_get_name(parameters.codec_id)));
    }
    codec_.reset(avcodec_alloc_context3(codec));
    avcodec_parameters_to_context(codec_.get(), &parameters);
    codec_->pkt_timebase = stream_->time_base;
    codec_->thread_count = threads_;
    codec_->thread_type = FF_THREAD_FRAME | FF_THREAD_SLICE;
    // A frame with errors is an error, not something the decoder makes up.
    codec_->err_recognition |= AV_EF_CRCCHECK | AV_EF_EXPLODE;
    if (const int opened = avcodec_open2(codec_.get(), codec, nullptr);
        opened < 0) {
      Fail(fmt::format("its video ({}) cannot be decoded ({})",
                       avcodec_get_name(parameters.codec_id),
                       LibavError(opened)));
    }
    current_ = -1;
    counted_ = 0;
    sent_ = 0;
    have_packet_ = false;
    draining_ = false;
  }

  std::string FormatName() const {
    const std::string name = format_->iformat->name;
    if (name.starts_with("mov,")) {
      const AVDictionaryEntry* const brand =
          av_dict_get(format_->metadata, "major_brand", nullptr, 0);
      return brand == nullptr || std::string_view(brand->value) == "qt  "
                 ? "mov"
                 : "mp4";
    }
    if (name.starts_with("matroska")) return "mkv";
    return name.substr(0, name.find(','));
  }

  // Makes ready to decode frame `index` and those after it.
  void StartFrom(std::int64_t index) {
    const std::size_t key = index_.pts.empty() ? 0 : index_.KeyPacketFor(index);
    if (can_seek_ && SeekTo(key)) return;
    can_seek_ = false;
    Open();
  }

  // Moves to packet number `key` or to a key packet before it; false if where
  // the container went to is not certain.
  bool SeekTo(std::size_t key) {
    const VideoPacket& wanted = index_.packets[key];
    const std::int64_t time =
        wanted.dts != AV_NOPTS_VALUE ? wanted.dts : wanted.pts;
    if (time == AV_NOPTS_VALUE ||
        av_seek_frame(format_.get(), stream_->index, time,
                      AVSEEK_FLAG_BACKWARD) < 0) {
      return false;
    }
    avcodec_flush_buffers(codec_.get());
    current_ = -1;
    counted_ = 0;
    draining_ = false;
    have_packet_ = false;
    if (!ReadPacket()) return false;
    const VideoPacket got = Describe(*packet_);
    const auto begin = index_.packets.begin();
    const auto end = begin + static_cast<std::ptrdiff_t>(key) + 1;
    const auto found =
        std::find_if(begin, end, [&](const auto& p) { return p.Is(got); });
    if (found == end || (found != begin && !found->key)) return false;
    sent_ = static_cast<std::size_t>(found - begin);
    return true;
  }

  // Gets the next packet of the video into packet_.
  bool ReadPacket() {
    if (have_packet_) return true;
    int result = 0;
    while ((result = av_read_frame(format_.get(), packet_.get())) >= 0) {
      if (packet_->stream_index == stream_->index && packet_->size > 0 &&
          (packet_->flags & AV_PKT_FLAG_CORRUPT) == 0) {
        have_packet_ = true;
        return true;
      }
      av_packet_unref(packet_.get());
    }
    if (result != AVERROR_EOF) trouble_ = LibavError(result);
    return false;
  }

  // Gives the decoder one packet, or the end of the stream.
  void Feed() {
    if (!ReadPacket()) {
      draining_ = true;
      avcodec_send_packet(codec_.get(), nullptr);
      return;
    }
    const int sent = avcodec_send_packet(codec_.get(), packet_.get());
    if (sent == AVERROR(EAGAIN)) return;  // it wants to be emptied first
    if (sent < 0) NoteLostFrame(sent);
    av_packet_unref(packet_.get());
    have_packet_ = false;
    ++sent_;
  }

  void NoteLostFrame(int error) {
    trouble_ = LibavError(error);
    ++counted_;
  }

  // Decodes one more frame into frame_ and sets current_; false at the end.
  bool DecodeNext() {
    for (;;) {
      const int result = avcodec_receive_frame(codec_.get(), frame_.get());
      if (result == AVERROR_EOF) return false;
      if (result == AVERROR(EAGAIN)) {
        if (draining_) return false;
        Feed();
      } else if (result < 0) {
        NoteLostFrame(result);
        if (!draining_) Feed();
      } else if (index_.pts.empty()) {
        current_ = counted_++;
        return true;
      } else {
        const std::int64_t time = frame_->pts != AV_NOPTS_VALUE
                                      ? frame_->pts
                                      : frame_->best_effort_timestamp;
        if (const auto number = index_.FrameAt(time)) {
          current_ = *number;
          return true;
        }
      }
    }
  }

  void DecodeUpTo(std::int64_t index) {
    trouble_.clear();
    while (current_ < index) {
      const std::int64_t before = current_;
      if (!DecodeNext()) {
        current_ = -1;  // the decoder is at its end
        break;
      }
      // Frames come in order; one that does not is of a damaged stream.
      if (current_ <= before) current_ = before;
    }
    if (current_ != index) {
      Fail(fmt::format("frame {} is damaged or missing{}", index,
                       trouble_.empty() ? "" : " (" + trouble_ + ")"));
    }
    if ((frame_->flags & AV_FRAME_FLAG_CORRUPT) != 0 ||
        frame_->decode_error_flags != 0) {
      Fail(fmt::format("frame {} is damaged", index));
    }
  }

  void LookAtFirstFrame() {
    const auto pixel_format = static_cast<AVPixelFormat>(frame_->format);
    if (!LumaReader::Reads(pixel_format)) {
      const char* const name = av_get_pix_fmt_name(pixel_format);
      Fail(
          fmt::format("its pixel format ({}) is not read; expected gray, YUV, "
                      "RGB or palette of 8 to 16 bits",
                      name != nullptr ? name : "unknown"));
    }
    Orientation orientation;
    if (const std::uint8_t* const matrix = av_stream_get_side_data(
            stream_, AV_PKT_DATA_DISPLAYMATRIX, nullptr)) {
      if (const auto turned =
              OrientationOf(reinterpret_cast<const std::int32_t*>(matrix))) {
        orientation = *turned;
      } else {
        info_.warnings.push_back(
            "the file asks to be shown turned by an odd angle; it is read as "
            "stored");
      }
    }
    // Phantom's 16-bit words carry fewer bits, which the decoder scales up.
    const bool cine = info_.format == "cine";
    reader_.emplace(pixel_format, orientation,
                    cine ? codec_->bits_per_coded_sample : 0);
    stored_width_ = frame_->width;
    stored_height_ = frame_->height;
    info_.width_px = orientation.transposed ? stored_height_ : stored_width_;
    info_.height_px = orientation.transposed ? stored_width_ : stored_height_;
    info_.bit_depth = reader_->bit_depth();
    if (cine) info_.first_camera_frame = CineFirstFrame();
    const AVRational aspect =
        av_guess_sample_aspect_ratio(format_.get(), stream_, frame_.get());
    if (aspect.num > 0 && aspect.num != aspect.den) {
      info_.warnings.push_back(fmt::format(
          "pixels are not square ({}:{}): angles in the picture are "
          "not those of the scene",
          aspect.num, aspect.den));
    }
    if (frame_->interlaced_frame != 0) {
      info_.warnings.push_back(
          "frames are interlaced: their odd and even rows were taken at "
          "different times");
    }
  }

  // FirstImageNo of the file header: a 32-bit integer at byte 16.
  std::int64_t CineFirstFrame() const {
    std::ifstream file(path_, std::ios::binary);
    std::int32_t number = 0;
    file.seekg(16);
    file.read(reinterpret_cast<char*>(&number), sizeof number);
    return file ? number : 0;
  }

  void SetTimeBase(const ClipOptions& options) {
    TimeBase& time = info_.time_base;
    if (!index_.uniform) {
      info_.warnings.push_back(fmt::format(
          "the file's frames are not equally spaced in time (mean {:.6g} fps)",
          index_.fps));
    }
    if (options.fps) {
      time = {*options.fps, FpsSource::kUser, true, true};
      return;
    }
    if (!(index_.fps > 0.0)) {
      Fail("the file tells no frame rate; give the camera's with --fps");
    }
    const bool cine = info_.format == "cine";  // has the camera's own rate
    time.fps = index_.fps;
    time.source = cine ? FpsSource::kHeader : FpsSource::kContainer;
    time.uniform = index_.uniform;
    const bool playback = !cine && IsPlaybackRate(time.fps);
    time.trusted = !playback && !index_.coarse;
    if (index_.coarse) {
      info_.warnings.push_back(
          fmt::format("the file's timestamps are too coarse to tell its frames "
                      "apart (about "
                      "{:.6g} fps); give the camera's rate with --fps",
                      time.fps));
    }
    if (playback) {
      info_.warnings.push_back(
          fmt::format("{:.6g} fps is a rate of playback; if the camera "
                      "recorded at another, "
                      "give it with --fps",
                      time.fps));
    }
  }

  double TimeOf(std::int64_t index) const {
    if (info_.time_base.uniform || index_.pts.empty()) {
      return static_cast<double>(index) / info_.time_base.fps;
    }
    return static_cast<double>(index_.pts[static_cast<std::size_t>(index)] -
                               index_.pts[0]) *
           av_q2d(stream_->time_base);
  }

  std::filesystem::path path_;
  std::int32_t threads_;
  LibavPtr<AVFormatContext> format_;
  LibavPtr<AVCodecContext> codec_;
  LibavPtr<AVPacket> packet_;
  LibavPtr<AVFrame> frame_;
  AVStream* stream_ = nullptr;  // of format_
  AVRational declared_rate_{0, 1};
  VideoIndex index_;
  ClipInfo info_;
  std::optional<LumaReader> reader_;
  std::int32_t stored_width_ = 0;
  std::int32_t stored_height_ = 0;

  bool can_seek_ = true;
  bool have_packet_ = false;   // packet_ waits to be sent
  bool draining_ = false;      // the decoder was told of the end
  std::size_t sent_ = 0;       // packets of index_ that the decoder has had
  std::int64_t counted_ = 0;   // frames out of the decoder, lost ones included
  std::int64_t current_ = -1;  // number of frame_; -1: none
  std::string trouble_;        // the decoder's last complaint
};

}  // namespace

std::unique_ptr<Clip> OpenVideo(const std::filesystem::path& path,
                                const ClipOptions& options) {
  // libav's log is of the whole program; its complaints come to us as codes.
  av_log_set_level(AV_LOG_QUIET);
  return std::make_unique<VideoClip>(path, options);
}

}  // namespace touchdown::vision
