// Damaged recordings for tests/fuzz/recordings.
// Usage: touchdown_mutate_recording seeds FOLDER
//            small recordings, one a file or a folder, in each container and
//            codec that the program writes
//        touchdown_mutate_recording SEED_FILE NUMBER OUT
//            the NUMBER-th damaged copy of a file; the same for the same number
//
// Half of the copies of a video are damaged in what they are made of: packets
// are left out, doubled, swapped, cut or filled with others' bytes, and sizes,
// rates and time bases are stated wrongly. The others, and pictures and raw
// clips, are damaged in their bytes; of PNGs checksums are then made right
// again, so that the damage gets past them.
extern "C" {
#include <libavformat/avformat.h>
#include <libavutil/crc.h>
}

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "touchdown/vision/footage/clip_writer.h"

namespace {

namespace fs = std::filesystem;
namespace vision = touchdown::vision;
using Random = std::mt19937_64;
using Bytes = std::vector<std::uint8_t>;

std::size_t Below(Random& random, std::size_t n) {
  return n == 0 ? 0 : random() % n;
}

// --- seeds -------------------------------------------------------------------

// Small and few, so that many damaged copies are read in little time; two and a
// half groups of predicted frames.
constexpr std::int32_t kWidth_px = 64;
constexpr std::int32_t kHeight_px = 48;
constexpr std::int64_t kFrames = 20;

// A bright disc that falls and rises again before a dark ground.
struct Film {
  std::int32_t bit_depth = 8;
  std::int64_t index = 0;
  Bytes bytes = {};

  std::optional<touchdown::core::Frame> Next() {
    if (index == kFrames) return std::nullopt;
    const std::size_t sample = bit_depth > 8 ? 2 : 1;
    bytes.assign(std::size_t{kWidth_px} * kHeight_px * sample, 0);
    const auto t = static_cast<double>(index) - 10.0;
    const double x0 = 10.0 + 2.0 * static_cast<double>(index);
    const double y0 = 33.0 - std::abs(t) * 1.6;
    for (std::int32_t y = 0; y < kHeight_px; ++y) {
      for (std::int32_t x = 0; x < kWidth_px; ++x) {
        const double r = std::hypot(x - x0, y - y0);
        const std::uint32_t level = r < 6.0 ? 200u : y > 39 ? 40u : 90u;
        const std::uint32_t value = level << (bit_depth - 8);
        std::uint8_t* const at =
            &bytes[(static_cast<std::size_t>(y) * kWidth_px +
                    static_cast<std::size_t>(x)) *
                   sample];
        at[0] = static_cast<std::uint8_t>(value);
        if (sample == 2) at[1] = static_cast<std::uint8_t>(value >> 8);
      }
    }
    touchdown::core::Frame frame;
    frame.data = reinterpret_cast<const std::byte*>(bytes.data());
    frame.stride_bytes = static_cast<std::ptrdiff_t>(kWidth_px * sample);
    frame.width_px = kWidth_px;
    frame.height_px = kHeight_px;
    frame.bit_depth = bit_depth;
    frame.index = index++;
    return frame;
  }
};

void WriteSeeds(const fs::path& folder) {
  const struct {
    const char* name;
    vision::VideoCodec codec;
    std::int32_t bit_depth;
  } videos[] = {{"mjpeg.avi", vision::VideoCodec::kMjpeg, 8},
                {"mjpeg.mov", vision::VideoCodec::kMjpeg, 8},
                {"mjpeg.mkv", vision::VideoCodec::kMjpeg, 8},
                {"h264.mp4", vision::VideoCodec::kH264, 8},
                {"h264.mov", vision::VideoCodec::kH264, 8},
                {"h264.mkv", vision::VideoCodec::kH264, 8},
                {"ffv1.avi", vision::VideoCodec::kFfv1, 8},
                {"ffv1_12.mkv", vision::VideoCodec::kFfv1, 12},
                {"raw.avi", vision::VideoCodec::kRaw, 8},
                {"raw_16.avi", vision::VideoCodec::kRaw, 16}};
  for (const auto& video : videos) {
    Film film{video.bit_depth};
    vision::VideoOptions options;
    options.codec = video.codec;
    options.fps = 500.0;
    options.key_frame_distance = 8;
    vision::WriteVideo(folder / video.name, options,
                       [&film] { return film.Next(); });
  }
  for (const auto& [name, kind] : {std::pair("png", vision::ImageKind::kPng),
                                   {"tiff", vision::ImageKind::kTiff},
                                   {"jpeg", vision::ImageKind::kJpeg}}) {
    Film film;
    vision::WriteImageFolder(folder / name, {kind},
                             [&film] { return film.Next(); });
  }
  Film film;
  vision::WriteMraw(folder / "raw.mraw", {}, [&film] { return film.Next(); });
}

// --- bytes -------------------------------------------------------------------

void DamageBytes(Bytes& bytes, Random& random) {
  const std::size_t times = 1 + Below(random, 8);
  for (std::size_t i = 0; i < times && !bytes.empty(); ++i) {
    // Headers are short: half of all damage is near the beginning or the end.
    const std::size_t reach = random() % 2 == 0
                                  ? bytes.size()
                                  : std::min<std::size_t>(bytes.size(), 512);
    std::size_t at = Below(random, reach);
    if (random() % 4 == 0) at = bytes.size() - 1 - at;
    const std::size_t length =
        std::min(bytes.size() - at, 1 + Below(random, 64));
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const auto end = begin + static_cast<std::ptrdiff_t>(length);
    switch (random() % 7) {
      case 0:
        bytes[at] ^= static_cast<std::uint8_t>(1u << random() % 8);
        break;
      case 1:
        std::fill(begin, end, std::uint8_t{0xFF});
        break;
      case 2:
        std::fill(begin, end, std::uint8_t{0});
        break;
      case 3:
        bytes[at] = static_cast<std::uint8_t>(random());
        break;
      case 4:
        bytes.erase(begin, end);
        break;
      case 5: {
        const Bytes copy(begin, end);
        const auto to = bytes.begin() + static_cast<std::ptrdiff_t>(
                                            Below(random, bytes.size()));
        bytes.insert(to, copy.begin(), copy.end());
        break;
      }
      default:
        if (i == 0) bytes.resize(at + 1);
    }
  }
}

// Checksums of a PNG's chunks, as far as chunks can be followed.
void RepairPng(Bytes& bytes) {
  const AVCRC* const table = av_crc_get_table(AV_CRC_32_IEEE_LE);
  const auto big = [&bytes](std::size_t at) {
    return std::uint32_t{bytes[at]} << 24 | std::uint32_t{bytes[at + 1]} << 16 |
           std::uint32_t{bytes[at + 2]} << 8 | bytes[at + 3];
  };
  for (std::size_t at = 8; at + 12 <= bytes.size();) {
    const std::size_t length = big(at);
    if (length > bytes.size() - at - 12) return;
    const std::uint32_t crc =
        av_crc(table, 0xFFFFFFFFu, &bytes[at + 4], length + 4) ^ 0xFFFFFFFFu;
    for (std::size_t i = 0; i < 4; ++i) {
      bytes[at + 8 + length + i] =
          static_cast<std::uint8_t>(crc >> (24 - 8 * i));
    }
    at += 12 + length;
  }
}

// --- packets -----------------------------------------------------------------

struct Packets {
  AVFormatContext* in = nullptr;
  std::vector<AVPacket*> all = {};
  ~Packets() {
    for (AVPacket*& packet : all) av_packet_free(&packet);
    avformat_close_input(&in);
  }
};

void DamagePacket(Packets& packets, Random& random) {
  auto& all = packets.all;
  if (all.empty()) return;
  const std::size_t at = Below(random, all.size());
  AVPacket* const packet = all[at];
  switch (random() % 7) {
    case 0:
      av_packet_free(&all[at]);
      all.erase(all.begin() + static_cast<std::ptrdiff_t>(at));
      break;
    case 1:
      all.insert(all.begin() + static_cast<std::ptrdiff_t>(at),
                 av_packet_clone(packet));
      break;
    case 2: {
      AVPacket* const other = all[Below(random, all.size())];
      std::swap(packet->data, other->data);
      std::swap(packet->size, other->size);
      std::swap(packet->buf, other->buf);
      break;
    }
    case 3:
      av_shrink_packet(
          packet, static_cast<int>(Below(
                      random, static_cast<std::size_t>(packet->size + 1))));
      break;
    case 4:
      if (av_packet_make_writable(packet) >= 0 && packet->size > 0) {
        for (int i = 0; i < 4; ++i) {
          packet->data[Below(random, static_cast<std::size_t>(packet->size))] =
              static_cast<std::uint8_t>(random());
        }
      }
      break;
    case 5:
      packet->flags ^= AV_PKT_FLAG_KEY;
      break;
    default:
      packet->pts += static_cast<std::int64_t>(Below(random, 2000)) - 1000;
  }
}

void DamageStatements(AVStream& stream, Random& random) {
  AVCodecParameters& parameters = *stream.codecpar;
  constexpr int kSides[] = {1, 7, 8, 97, 4096, 65535};
  switch (random() % 5) {
    case 0:
      parameters.width = kSides[Below(random, std::size(kSides))];
      break;
    case 1:
      parameters.height = kSides[Below(random, std::size(kSides))];
      break;
    case 2:
      stream.time_base = {1, static_cast<int>(1 + Below(random, 2000000000))};
      break;
    case 3:
      stream.avg_frame_rate = {static_cast<int>(Below(random, 1 << 30)),
                               static_cast<int>(1 + Below(random, 1000))};
      break;
    default:
      if (parameters.extradata_size > 0) {
        parameters.extradata[Below(
            random, static_cast<std::size_t>(parameters.extradata_size))] =
            static_cast<std::uint8_t>(random());
      }
  }
}

// False where the container does not take what the damage made of it.
bool DamagePackets(const fs::path& from, const fs::path& to, Random& random) {
  Packets packets;
  if (avformat_open_input(&packets.in, from.c_str(), nullptr, nullptr) < 0 ||
      avformat_find_stream_info(packets.in, nullptr) < 0) {
    return false;
  }
  for (AVPacket* packet = av_packet_alloc();; packet = av_packet_alloc()) {
    if (av_read_frame(packets.in, packet) < 0) {
      av_packet_free(&packet);
      break;
    }
    packets.all.push_back(packet);
  }
  const std::size_t times = 1 + Below(random, 6);
  for (std::size_t i = 0; i < times; ++i) DamagePacket(packets, random);
  AVFormatContext* out = nullptr;
  if (avformat_alloc_output_context2(&out, nullptr, nullptr, to.c_str()) < 0) {
    return false;
  }
  AVStream* const stream = avformat_new_stream(out, nullptr);
  const AVStream& source = *packets.in->streams[0];
  avcodec_parameters_copy(stream->codecpar, source.codecpar);
  stream->codecpar->codec_tag = 0;
  stream->time_base = source.time_base;
  stream->avg_frame_rate = source.avg_frame_rate;
  if (random() % 3 == 0) DamageStatements(*stream, random);
  bool written = avio_open(&out->pb, to.c_str(), AVIO_FLAG_WRITE) >= 0 &&
                 avformat_write_header(out, nullptr) >= 0;
  for (std::size_t i = 0; written && i < packets.all.size(); ++i) {
    AVPacket& packet = *packets.all[i];
    packet.stream_index = 0;
    packet.pos = -1;
    av_packet_rescale_ts(&packet, source.time_base, stream->time_base);
    av_write_frame(out, &packet);  // what is refused is left out
  }
  written = written && av_write_trailer(out) >= 0;
  if (out->pb != nullptr) avio_closep(&out->pb);
  avformat_free_context(out);
  return written;
}

bool IsVideo(const fs::path& path) {
  constexpr const char* kVideos[] = {".avi", ".mov", ".mp4", ".mkv"};
  return std::any_of(
      std::begin(kVideos), std::end(kVideos),
      [&path](const char* video) { return path.extension() == video; });
}

void Mutate(const fs::path& from, std::uint64_t number, const fs::path& to) {
  Random random(number);
  if (IsVideo(from) && random() % 2 == 0 && DamagePackets(from, to, random)) {
    return;
  }
  std::ifstream in(from, std::ios::binary);
  Bytes bytes((std::istreambuf_iterator<char>(in)),
              std::istreambuf_iterator<char>());
  DamageBytes(bytes, random);
  if (from.extension() == ".png") RepairPng(bytes);
  std::ofstream(to, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

int main(int argc, char** argv) {
  av_log_set_level(AV_LOG_QUIET);
  try {
    if (argc == 3 && std::strcmp(argv[1], "seeds") == 0) {
      fs::create_directories(argv[2]);
      WriteSeeds(argv[2]);
    } else if (argc == 4) {
      Mutate(argv[1], std::stoull(argv[2]), argv[3]);
    } else {
      std::fprintf(stderr,
                   "usage: touchdown_mutate_recording seeds FOLDER | SEED_FILE "
                   "NUMBER OUT\n");
      return 2;
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "touchdown_mutate_recording: %s\n", error.what());
    return 1;
  }
  return 0;
}
