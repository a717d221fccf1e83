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
#include <thread>

#include "footage/formats/chroma.h"
#include "footage/formats/clip_formats.h"
#include "footage/formats/libav.h"
#include "footage/formats/luma.h"
#include "footage/formats/video_index.h"
#include "footage/formats/video_source.h"
#include "footage/formats/video_times.h"
#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

// A palette in which each index is its own brightness.
std::vector<std::uint8_t> GrayRamp() {
  std::vector<std::uint8_t> palette;
  for (int i = 0; i < AVPALETTE_COUNT; ++i) {
    const auto level = static_cast<std::uint8_t>(i);
    palette.insert(palette.end(), {level, level, level, 0xFF});
  }
  return palette;
}

// A video through libav. Decoding goes forward as long as it can; going back,
// or far ahead, means a seek to the key packet before the frame.
class VideoClip final : public Clip {
 public:
  VideoClip(const std::filesystem::path& path, const ClipOptions& options,
            FrameMemory* memory)
      : path_(path),
        memory_(memory),
        threads_(options.decoder_threads > 0
                     ? options.decoder_threads
                     : static_cast<std::int32_t>(
                           std::max(1u, std::thread::hardware_concurrency()))),
        source_(OpenVideoSource(path, threads_, memory_)),
        packet_(Libav().av_packet_alloc()),
        frame_(Libav().av_frame_alloc()) {
    info_.path = path;
    info_.format = FormatName(*source_.format);
    index_ =
        IndexVideo(*source_.format, *source_.stream, source_.declared_rate);
    if (index_.ended_early.empty() && IsCut(path)) {
      index_.ended_early = "the file is shorter than its header says";
    }
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
    if (info_.format == "cine") {
      companded_ = TakeCineHeader(path, options, index_, info_);
    }
    if (source_.codec->codec_id == AV_CODEC_ID_RAWVIDEO &&
        source_.codec->pix_fmt == AV_PIX_FMT_PAL8 && index_.palette.empty()) {
      index_.palette = GrayRamp();
      info_.warnings.push_back(
          "the file has no palette: its 8-bit samples are taken as gray");
    }
    are_alone_ =
        !index_.pts.empty() &&
        std::all_of(index_.packets.begin(), index_.packets.end(),
                    [](const VideoPacket& packet) { return packet.key; });
    info_.is_predicted = !index_.pts.empty() && !are_alone_;
    PrepareDecoding(0);
    AdvanceDecoder(0);
    LookAtFirstFrame(options.channel);
    SetTimeBase(index_, options, info_);
  }

  // Reads what `like` reads, with one thread.
  explicit VideoClip(const VideoClip& like)
      : path_(like.path_),
        memory_(like.memory_),
        threads_(1),
        source_(OpenVideoSource(path_, threads_, memory_)),
        packet_(Libav().av_packet_alloc()),
        frame_(Libav().av_frame_alloc()),
        index_(like.index_),
        are_alone_(like.are_alone_),
        info_(like.info_),
        reader_(like.reader_),
        chroma_(like.chroma_),
        stored_width_(like.stored_width_),
        stored_height_(like.stored_height_),
        can_seek_(like.can_seek_) {}

  const ClipInfo& info() const override { return info_; }

  // Another decoder pays only where it can start at any frame: elsewhere each
  // would decode from a key frame on.
  std::unique_ptr<Clip> Another() const override {
    return can_seek_ && are_alone_ ? std::make_unique<VideoClip>(*this)
                                   : nullptr;
  }

  // The frame at which decoding must begin for frame `index`.
  std::int64_t EntryFrame(std::int64_t index) const override {
    if (index_.pts.empty()) return 0;
    const std::size_t key = index_.FindKeyPacket(index);
    return index_.FindFrame(index_.packets[key].pts).value_or(0);
  }

 protected:
  core::Frame ReadWindow(std::int64_t index,
                         const core::PixelRect& window) override {
    if (index != current_ || (index >= bad_from_ && index < bad_to_)) {
      // Forwards, skipping must save more decoding than it throws away.
      const bool back = index < current_ || current_ < 0;
      const bool far = !back && index > current_ + threads_ &&
                       !index_.pts.empty() &&
                       index_.FindKeyPacket(index) >
                           sent_ + static_cast<std::size_t>(threads_);
      if (back || (far && can_seek_)) PrepareDecoding(index);
      if (far && !can_seek_ && are_alone_) {
        SkipPackets(index_.FindKeyPacket(index));
      }
      AdvanceDecoder(index);
    }
    if (frame_->width != stored_width_ || frame_->height != stored_height_ ||
        frame_->format != reader_->format()) {
      Fail(
          fmt::format("frame {} is of another size or pixel format than the "
                      "first",
                      index));
    }
    core::Frame view = chroma_ ? chroma_->View(*frame_, window)
                               : reader_->View(*frame_, window);
    view.time_s = FrameTime(index_, info_.time_base, index);
    return view;
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const {
    throw core::InputError(fmt::format("{}: {}", path_.string(), what));
  }

  // Makes ready to decode frame `index` and those after it.
  void PrepareDecoding(std::int64_t index) {
    const std::size_t key =
        index_.pts.empty() ? 0 : index_.FindKeyPacket(index);
    if (can_seek_ && SeekPacket(key)) return;
    can_seek_ = false;
    source_ = OpenVideoSource(path_, threads_, memory_);
    Rewind();
  }

  // Moves on to packet number `key`, of which each is a key: what lies before
  // it is read and not decoded.
  void SkipPackets(std::size_t key) {
    Libav().avcodec_flush_buffers(source_.codec.get());
    draining_ = false;
    while (sent_ < key && ReadPacket()) {
      Libav().av_packet_unref(packet_.get());
      have_packet_ = false;
      ++sent_;
    }
    expected_ = index_.FindFrame(index_.packets[key].pts).value_or(expected_);
  }

  // Forgets what the decoder was doing.
  void Rewind() {
    current_ = -1;
    counted_ = 0;
    sent_ = 0;
    expected_ = 0;
    bad_from_ = bad_to_ = -1;
    have_packet_ = false;
    draining_ = false;
    Libav().av_packet_unref(packet_.get());
  }

  // Moves to packet number `key` or to a key packet before it; false if where
  // the container went to is not certain. Some containers look for the time at
  // which a packet is shown (asked for the time of decoding they go back to the
  // key packet before), others for that of decoding (asked for the later time
  // they may go too far).
  bool SeekPacket(std::size_t key) {
    const VideoPacket& wanted = index_.packets[key];
    return SeekToTime(wanted.pts, key) ||
           (wanted.dts != wanted.pts && SeekToTime(wanted.dts, key));
  }

  bool SeekToTime(std::int64_t time, std::size_t key) {
    if (time == AV_NOPTS_VALUE ||
        Libav().av_seek_frame(source_.format.get(), source_.stream->index, time,
                              AVSEEK_FLAG_BACKWARD) < 0) {
      return false;
    }
    Libav().avcodec_flush_buffers(source_.codec.get());
    Rewind();
    if (!ReadPacket()) return false;
    const VideoPacket got = Describe(*packet_);
    const auto begin = index_.packets.begin();
    const auto end = begin + static_cast<std::ptrdiff_t>(key) + 1;
    const auto found =
        std::find_if(begin, end, [&](const auto& p) { return p.Is(got); });
    // Only a packet of the list, no later than the wanted one and a key (or the
    // first), is believed.
    if (found == end || (found != begin && !found->key)) return false;
    sent_ = static_cast<std::size_t>(found - begin);
    expected_ = index_.FindFrame(found->pts).value_or(0);
    return true;
  }

  // Gets the next packet of the video into packet_.
  bool ReadPacket() {
    if (have_packet_) return true;
    int result = 0;
    while ((result = Libav().av_read_frame(source_.format.get(),
                                           packet_.get())) >= 0) {
      if (packet_->stream_index == source_.stream->index && packet_->size > 0 &&
          (packet_->flags & AV_PKT_FLAG_CORRUPT) == 0) {
        have_packet_ = true;
        return true;
      }
      Libav().av_packet_unref(packet_.get());
    }
    if (result != AVERROR_EOF) trouble_ = LibavError(result);
    return false;
  }

  // Gives the decoder one packet, or the end of the stream.
  void Feed() {
    if (!ReadPacket()) {
      draining_ = true;
      Libav().avcodec_send_packet(source_.codec.get(), nullptr);
      return;
    }
    GivePalette();
    const int sent =
        Libav().avcodec_send_packet(source_.codec.get(), packet_.get());
    if (sent == AVERROR(EAGAIN)) return;  // it wants to be emptied first
    if (sent < 0) NoteLostFrame(sent);
    Libav().av_packet_unref(packet_.get());
    have_packet_ = false;
    ++sent_;
  }

  // The decoder forgets the palette at a seek; the demuxer tells it once.
  void GivePalette() {
    if (index_.palette.empty() ||
        Libav().av_packet_get_side_data(packet_.get(), AV_PKT_DATA_PALETTE,
                                        nullptr) != nullptr) {
      return;
    }
    if (std::uint8_t* const palette = Libav().av_packet_new_side_data(
            packet_.get(), AV_PKT_DATA_PALETTE, index_.palette.size())) {
      std::copy(index_.palette.begin(), index_.palette.end(), palette);
    }
  }

  void NoteLostFrame(int error) {
    trouble_ = LibavError(error);
    ++counted_;
  }

  // Decodes one more frame into frame_ and sets current_; false at the end.
  // Frames are known by their timestamp in the index, or by counting where they
  // have none.
  bool DecodeNext() {
    for (;;) {
      // Up to a key frame's distance of them for one that is asked for.
      cancellation().Check();
      const int result =
          Libav().avcodec_receive_frame(source_.codec.get(), frame_.get());
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
        if (const auto number = index_.FindFrame(time)) {
          current_ = *number;
          return true;
        }
      }
    }
  }

  // Decodes up to frame `index`. Throws where it, or a frame that it depends
  // on, is damaged or missing.
  void AdvanceDecoder(std::int64_t index) {
    trouble_.clear();
    while (current_ < index) {
      if (!DecodeNext()) {
        current_ = -1;  // the decoder is at its end
        break;
      }
      // Frames of an open group that precede the key frame we began with.
      if (current_ < expected_) continue;
      // A lost frame spoils those that are predicted from it: none is believed
      // up to the next key frame.
      const bool damaged = (frame_->flags & AV_FRAME_FLAG_CORRUPT) != 0 ||
                           frame_->decode_error_flags != 0 ||
                           std::binary_search(index_.damaged.begin(),
                                              index_.damaged.end(), current_);
      if (current_ > expected_ || damaged) {
        bad_from_ = expected_;
        bad_to_ = index_.NextKeyFrame(expected_);
      }
      expected_ = current_ + 1;
    }
    if (current_ != index || (index >= bad_from_ && index < bad_to_)) {
      const std::string why = trouble_.empty() ? "" : " (" + trouble_ + ")";
      Fail(
          current_ != index || index == bad_from_
              ? fmt::format("frame {} is damaged or missing{}", index, why)
              : fmt::format("frame {} depends on frame {}, which is damaged or "
                            "missing{}",
                            index, bad_from_, why));
    }
  }

  // Takes size, depth and orientation from the first decoded frame: containers
  // are often wrong about them.
  void LookAtFirstFrame(Channel channel) {
    const auto pixel_format = static_cast<AVPixelFormat>(frame_->format);
    if (!LumaReader::Reads(pixel_format)) {
      const char* const name = Libav().av_get_pix_fmt_name(pixel_format);
      Fail(
          fmt::format("its pixel format ({}) is not read; expected gray, YUV, "
                      "RGB or palette of 8 to 16 bits",
                      name != nullptr ? name : "unknown"));
    }
    Orientation orientation;
    if (const std::uint8_t* const matrix = Libav().av_stream_get_side_data(
            source_.stream, AV_PKT_DATA_DISPLAYMATRIX, nullptr)) {
      if (const auto turned =
              ReadOrientation(reinterpret_cast<const std::int32_t*>(matrix))) {
        orientation = *turned;
      } else {
        info_.warnings.push_back(
            "the file asks to be shown turned by an odd angle; it is read as "
            "stored");
      }
    }
    const bool cine = info_.format == "cine";
    // Phantom's 16-bit words carry fewer bits, which the decoder scales up.
    reader_.emplace(pixel_format, orientation,
                    cine ? source_.codec->bits_per_coded_sample : 0);
    if (companded_ && reader_->bit_depth() == kCineCodeBits) {
      reader_->UndoCineCurve();
    } else if (companded_) {
      info_.warnings.push_back(
          "samples of packed .cine follow the camera's companding curve: they "
          "are not linear in light");
    }
    stored_width_ = frame_->width;
    stored_height_ = frame_->height;
    info_.width_px = orientation.transposed ? stored_height_ : stored_width_;
    info_.height_px = orientation.transposed ? stored_width_ : stored_height_;
    info_.bit_depth = reader_->bit_depth();
    info_.has_colour = ChromaReader::Reads(pixel_format);
    if (channel != Channel::kLuma) {
      if (!info_.has_colour) {
        throw std::invalid_argument(
            fmt::format("channel is {}, but {} has no colour that is read",
                        Name(channel), path_.string()));
      }
      chroma_.emplace(pixel_format, orientation, channel);
      info_.bit_depth = 8;
      info_.gamma_is_known = true;
    }
    const AVRational aspect = Libav().av_guess_sample_aspect_ratio(
        source_.format.get(), source_.stream, frame_.get());
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

  std::filesystem::path path_;
  FrameMemory* memory_;  // for frames; null: libav's own
  std::int32_t threads_;
  VideoSource source_;
  LibavPtr<AVPacket> packet_;
  LibavPtr<AVFrame> frame_;
  VideoIndex index_;
  bool are_alone_ = false;  // frames can be told apart, and each is a key
  ClipInfo info_;
  std::optional<LumaReader> reader_;
  std::optional<ChromaReader>
      chroma_;              // where a colour difference is asked for
  bool companded_ = false;  // a .cine of packed 10-bit samples
  std::int32_t stored_width_ = 0;
  std::int32_t stored_height_ = 0;

  bool can_seek_ = true;
  bool have_packet_ = false;    // packet_ waits to be sent
  bool draining_ = false;       // the decoder was told of the end
  std::size_t sent_ = 0;        // packets of index_ that the decoder has had
  std::int64_t counted_ = 0;    // frames out of the decoder, lost ones included
  std::int64_t current_ = -1;   // number of frame_; -1: none
  std::int64_t expected_ = 0;   // number of the frame that should come next
  std::int64_t bad_from_ = -1;  // frames [bad_from_, bad_to_) are not believed
  std::int64_t bad_to_ = -1;
  std::string trouble_;  // the decoder's last complaint
};

}  // namespace

std::unique_ptr<Clip> OpenVideo(const std::filesystem::path& path,
                                const ClipOptions& options,
                                FrameMemory* memory) {
  // libav's log is of the whole program; its complaints come to us as codes.
  Libav().av_log_set_level(AV_LOG_QUIET);
  return std::make_unique<VideoClip>(path, options, memory);
}

}  // namespace touchdown::vision
