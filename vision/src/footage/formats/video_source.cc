#include "footage/formats/video_source.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <string_view>
#include <vector>

#include "footage/apart/frame_memory.h"
#include "footage/formats/frame_buffers.h"
#include "touchdown/core/errors.h"

namespace touchdown::vision {
namespace {

// Containers that hold one recording in one file. Play lists and the like,
// which make libav open other files, are not among them.
constexpr char kContainers[] =
    "avi,mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,cine,mpegts,mpeg,asf,flv,ogg,"
    "nut,gif,yuv4mpegpipe,ivf,h264,hevc,m4v,mjpeg,apng,mxf,dv";

[[noreturn]] void Fail(const std::filesystem::path& path,
                       const std::string& what) {
  throw core::InputError(fmt::format("{}: {}", path.string(), what));
}

// libav asks before each read whether to go on.
int OnInterruptCheck(void* memory) {
  static_cast<FrameMemory*>(memory)->Beat();
  return 0;
}

LibavPtr<AVFormatContext> OpenContainer(const std::filesystem::path& path,
                                        FrameMemory* memory) {
  const LibavFunctions& libav = Libav();  // before there is what may leak
  AVDictionary* options = nullptr;
  Libav().av_dict_set(&options, "format_whitelist", kContainers, 0);
  Libav().av_dict_set(&options, "protocol_whitelist", "file", 0);
  AVFormatContext* format = libav.avformat_alloc_context();
  if (memory != nullptr && format != nullptr) {
    format->interrupt_callback = {OnInterruptCheck, memory};
  }
  // The prefix keeps a name like "http:a.avi" a name.
  const int opened = libav.avformat_open_input(
      &format, ("file:" + path.string()).c_str(), nullptr, &options);
  Libav().av_dict_free(&options);
  if (opened < 0) {
    Fail(path, fmt::format("not a recording that can be read ({}); expected a "
                           "video, an .mraw with its header, or a folder of "
                           "images",
                           LibavError(opened)));
  }
  return LibavPtr<AVFormatContext>(format);
}

LibavPtr<AVCodecContext> OpenDecoder(const std::filesystem::path& path,
                                     AVStream& stream, std::int32_t threads,
                                     FrameMemory* memory) {
  AVCodecParameters& parameters = *stream.codecpar;
  if (parameters.codec_id == AV_CODEC_ID_NONE &&
      parameters.codec_tag == MKTAG('Y', '1', '6', ' ')) {
    // 16-bit gray of machine-vision cameras, which libav does not know in .avi.
    parameters.codec_id = AV_CODEC_ID_RAWVIDEO;
    parameters.codec_tag =
        Libav().avcodec_pix_fmt_to_codec_tag(AV_PIX_FMT_GRAY16LE);
  }
  const AVCodec* const codec =
      Libav().avcodec_find_decoder(parameters.codec_id);
  if (codec == nullptr) {
    Fail(path, fmt::format("there is no decoder for its video ({})",
                           Libav().avcodec_get_name(parameters.codec_id)));
  }
  LibavPtr<AVCodecContext> context(Libav().avcodec_alloc_context3(codec));
  Libav().avcodec_parameters_to_context(context.get(), &parameters);
  context->pkt_timebase = stream.time_base;
  context->thread_count = threads;
  if (memory != nullptr) UseFrameMemory(*memory, *context);
  // libavcodec's MPEG-4 part 2 (ffmpeg 5.1) ends the process by an assertion
  // where a damaged frame is given up (AV_EF_EXPLODE) while another thread
  // waits for it: no frame threads for it, which costs its speed on several
  // cores.
  context->thread_type = parameters.codec_id == AV_CODEC_ID_MPEG4
                             ? FF_THREAD_SLICE
                             : FF_THREAD_FRAME | FF_THREAD_SLICE;
  // Beyond any camera; a damaged header cannot make the decoder ask for more.
  context->max_pixels = std::int64_t{1} << 28;
  // A frame with errors is an error, not something the decoder makes up.
  context->err_recognition |= AV_EF_CRCCHECK | AV_EF_EXPLODE;
  if (const int opened = Libav().avcodec_open2(context.get(), codec, nullptr);
      opened < 0) {
    Fail(path, fmt::format("its video ({}) cannot be decoded ({})",
                           Libav().avcodec_get_name(parameters.codec_id),
                           LibavError(opened)));
  }
  return context;
}

}  // namespace

VideoSource OpenVideoSource(const std::filesystem::path& path,
                            std::int32_t threads, FrameMemory* memory) {
  VideoSource source;
  source.format = OpenContainer(path, memory);
  AVFormatContext& format = *source.format;
  // What the container itself says, before it is overridden by guesses.
  std::vector<AVRational> declared;
  for (unsigned i = 0; i < format.nb_streams; ++i) {
    declared.push_back(format.streams[i]->avg_frame_rate);
  }
  if (const int found = Libav().avformat_find_stream_info(&format, nullptr);
      found < 0) {
    Fail(path,
         fmt::format("damaged before its first frame ({})", LibavError(found)));
  }
  const int best = Libav().av_find_best_stream(&format, AVMEDIA_TYPE_VIDEO, -1,
                                               -1, nullptr, 0);
  for (unsigned i = 0; i < format.nb_streams; ++i) {
    AVStream* const stream = format.streams[i];
    if (static_cast<int>(i) == best &&
        (stream->disposition & AV_DISPOSITION_ATTACHED_PIC) == 0) {
      source.stream = stream;
      if (i < declared.size()) source.declared_rate = declared[i];
    } else {
      stream->discard = AVDISCARD_ALL;
    }
  }
  if (source.stream == nullptr) Fail(path, "there is no video in it");
  source.codec = OpenDecoder(path, *source.stream, threads, memory);
  return source;
}

std::string FormatName(const AVFormatContext& format) {
  const std::string name = format.iformat->name;
  if (name.starts_with("mov,")) {
    const AVDictionaryEntry* const brand =
        Libav().av_dict_get(format.metadata, "major_brand", nullptr, 0);
    return brand == nullptr || std::string_view(brand->value) == "qt  " ? "mov"
                                                                        : "mp4";
  }
  if (name.starts_with("matroska")) return "mkv";
  return name.substr(0, name.find(','));
}

// Whether the file is shorter than its own head says: RIFF (.avi) and Matroska
// state their length.
bool IsCut(const std::filesystem::path& path) {
  std::error_code trouble;
  const std::uintmax_t size = std::filesystem::file_size(path, trouble);
  std::array<std::uint8_t, 128> head{};
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(head.data()), head.size());
  if (trouble || file.gcount() < 32) return false;

  if (std::memcmp(head.data(), "RIFF", 4) == 0) {
    std::uint32_t length = 0;
    std::memcpy(&length, head.data() + 4, 4);
    return length != 0 && length != UINT32_MAX && size < 8ull + length;
  }
  // EBML (RFC 8794): an element is its id, its length as a number whose leading
  // zero bits tell how many bytes it takes, and that many bytes.
  const auto number = [&](std::size_t at, std::size_t& bytes) {
    bytes = static_cast<std::size_t>(std::countl_zero(head[at])) + 1;
    std::uint64_t value = bytes > 8 ? 0 : head[at] & (0xFFu >> bytes);
    for (std::size_t i = 1; i < bytes && bytes <= 8; ++i) {
      value = value << 8 | head[at + i];
    }
    return value;
  };
  // Ids of the elements that a Matroska file begins with.
  constexpr std::array<std::uint8_t, 4> kEbml = {0x1A, 0x45, 0xDF, 0xA3};
  constexpr std::array<std::uint8_t, 4> kSegment = {0x18, 0x53, 0x80, 0x67};
  if (std::memcmp(head.data(), kEbml.data(), 4) != 0) return false;
  std::size_t bytes = 0;
  const std::uint64_t header = number(4, bytes);
  if (header > head.size() - 32) return false;
  const std::size_t segment = 4 + bytes + static_cast<std::size_t>(header);
  if (std::memcmp(head.data() + segment, kSegment.data(), 4) != 0) return false;
  const std::uint64_t length = number(segment + 4, bytes);
  const std::uint64_t unknown = (std::uint64_t{1} << (7 * bytes)) - 1;
  return bytes <= 8 && length != unknown && size < segment + 4 + bytes + length;
}

}  // namespace touchdown::vision
