#include "footage/formats/video_index.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>

#include "footage/formats/ffv1_check.h"

namespace touchdown::vision {
namespace {

// The frame rate: what the container says if the timestamps agree with it, else
// what they say themselves.
void FindRate(const std::vector<std::int64_t>& pts, const AVStream& stream,
              AVRational declared, VideoIndex& index) {
  const double tick_s = av_q2d(stream.time_base);
  const auto rate = [](AVRational r) {
    return r.num > 0 && r.den > 0 ? av_q2d(r) : 0.0;
  };
  std::vector<double> times_s;
  times_s.reserve(pts.size());
  for (const std::int64_t time : pts) {
    times_s.push_back(CountTicks(pts[0], time) * tick_s);
  }
  index.spacing = FindSpacing(
      times_s,
      {rate(declared), rate(stream.avg_frame_rate), rate(stream.r_frame_rate)},
      {.tick_s = tick_s});
}

void TakePalette(const AVPacket& packet, VideoIndex& index) {
  std::size_t size = 0;
  const std::uint8_t* const palette =
      Libav().av_packet_get_side_data(&packet, AV_PKT_DATA_PALETTE, &size);
  if (palette != nullptr && size == AVPALETTE_SIZE && index.palette.empty()) {
    index.palette.assign(palette, palette + size);
  }
}

// Frames before a key frame in time may follow it in the file (open groups);
// they need the one before. So the key frame itself must not be later.
void FindKeyPackets(VideoIndex& index) {
  const std::vector<VideoPacket>& packets = index.packets;
  index.key_packets.reserve(index.pts.size());
  std::vector<std::size_t> later;  // key packets that are shown later
  std::size_t best = 0;
  std::size_t i = 0;
  for (const std::int64_t time : index.pts) {
    for (; i < packets.size() &&
           (packets[i].dts == AV_NOPTS_VALUE || packets[i].dts <= time);
         ++i) {
      if (packets[i].key) later.push_back(i);
    }
    std::erase_if(later, [&](std::size_t key) {
      const bool shown = packets[key].pts <= time;
      if (shown) best = std::max(best, key);
      return shown;
    });
    index.key_packets.push_back(best);
  }
}

// The container's own list of an uncompressed stream, if it names every frame
// and the file has room for the last.
std::optional<VideoIndex> IndexByList(AVFormatContext& format, AVStream& stream,
                                      AVRational declared) {
  const int count = Libav().avformat_index_get_entries_count(&stream);
  const std::int64_t frames =
      stream.nb_frames > 0 ? stream.nb_frames : stream.duration;
  if (stream.codecpar->codec_id != AV_CODEC_ID_RAWVIDEO || count < 2 ||
      count != frames) {
    return std::nullopt;
  }
  const std::int64_t size =
      format.pb == nullptr ? 0 : Libav().avio_size(format.pb);
  VideoIndex index;
  std::int64_t before = 0;
  std::int64_t end = 0;
  for (int i = 0; i < count; ++i) {
    const AVIndexEntry* const entry =
        Libav().avformat_index_get_entry(&stream, i);
    // .cine lists no sizes; elsewhere an empty chunk stands for a lost frame.
    const bool sizes = std::string_view(format.iformat->name) != "cine";
    const bool in_order =
        i == 0 || (entry->timestamp > index.pts.back() && entry->pos > before);
    // Positions beyond the end could overflow the sum below.
    if (!in_order || entry->pos < 0 || entry->pos > size ||
        (sizes && entry->size <= 0) || (entry->flags & AVINDEX_KEYFRAME) == 0) {
      return std::nullopt;
    }
    end = entry->pos + (sizes ? entry->size : entry->pos - before);
    before = entry->pos;
    index.packets.push_back({entry->timestamp, entry->timestamp, -1, true});
    index.pts.push_back(entry->timestamp);
  }
  if (end > size) return std::nullopt;
  index.frames = count;
  FindKeyPackets(index);
  const LibavPtr<AVPacket> first(Libav().av_packet_alloc());
  if (Libav().av_read_frame(&format, first.get()) >= 0) {
    TakePalette(*first, index);
  }
  FindRate(index.pts, stream, declared, index);
  return index;
}

// In .avi an empty chunk stands for a lost frame: it has its tick, a period,
// and its place in the list, but is never seen. Up to `last_dts` all is there
// then.
bool CountsLostFrames(const AVStream& stream, AVRational declared,
                      std::int64_t last_dts) {
  return declared.num > 0 &&
         av_cmp_q(av_inv_q(declared), stream.time_base) == 0 &&
         last_dts != AV_NOPTS_VALUE && last_dts >= stream.nb_frames - 1;
}

}  // namespace

double CountTicks(std::int64_t begin, std::int64_t end) {
  return static_cast<double>(end) - static_cast<double>(begin);
}

VideoPacket Describe(const AVPacket& packet) {
  return {packet.pts, packet.dts, packet.pos,
          (packet.flags & AV_PKT_FLAG_KEY) != 0};
}

// Number of the frame with this time; nothing where there is none.
std::optional<std::int64_t> VideoIndex::FindFrame(std::int64_t time) const {
  const auto found = std::lower_bound(pts.begin(), pts.end(), time);
  if (found == pts.end() || *found != time) return std::nullopt;
  return found - pts.begin();
}

std::int64_t VideoIndex::NextKeyFrame(std::int64_t index) const {
  std::int64_t after = frames;
  if (pts.empty()) {
    // Without timestamps, frames are in the order of their packets.
    const auto begin = packets.begin() + static_cast<std::ptrdiff_t>(index) + 1;
    const auto key = std::find_if(begin, packets.end(),
                                  [](const VideoPacket& p) { return p.key; });
    return std::min<std::int64_t>(key - packets.begin(), frames);
  }
  const std::int64_t time = pts[static_cast<std::size_t>(index)];
  for (const VideoPacket& packet : packets) {
    if (!packet.key || packet.pts <= time) continue;
    if (const auto frame = FindFrame(packet.pts))
      after = std::min(after, *frame);
  }
  return after;
}

// Lists all packets of the video, by the container's own list or by reading the
// file once: frame numbers are then exact whatever the container's seek does.
VideoIndex IndexVideo(AVFormatContext& format, AVStream& stream,
                      AVRational declared) {
  if (auto listed = IndexByList(format, stream, declared)) return *listed;
  VideoIndex index;
  const LibavPtr<AVPacket> packet(Libav().av_packet_alloc());
  std::vector<std::int64_t> pts;
  std::vector<std::int64_t> damaged;  // their presentation times
  std::vector<std::int64_t> damaged_numbers;
  bool has_sums = stream.codecpar->codec_id == AV_CODEC_ID_FFV1;
  std::int64_t last_dts = AV_NOPTS_VALUE;
  bool timed = true;
  int result = 0;
  while ((result = Libav().av_read_frame(&format, packet.get())) >= 0) {
    const bool whole = (packet->flags & AV_PKT_FLAG_CORRUPT) == 0;
    if (packet->stream_index == stream.index && packet->size > 0) {
      if (!whole) {
        // The file ends within this frame.
        index.ended_early = "the last frame is cut";
        Libav().av_packet_unref(packet.get());
        break;
      }
      index.packets.push_back(Describe(*packet));
      TakePalette(*packet, index);
      // Frames before the start of an edit list are decoded but not shown.
      if ((packet->flags & AV_PKT_FLAG_DISCARD) == 0) {
        const std::span<const std::uint8_t> bytes(
            packet->data, static_cast<std::size_t>(packet->size));
        if (has_sums && !Ffv1SumsHold(bytes)) {
          if (index.frames == 0) {
            has_sums = false;  // written without them
          } else {
            damaged.push_back(packet->pts);
            damaged_numbers.push_back(index.frames);
          }
        }
        ++index.frames;
        timed = timed && packet->pts != AV_NOPTS_VALUE;
        pts.push_back(packet->pts);
      }
      last_dts = packet->dts;
    }
    Libav().av_packet_unref(packet.get());
  }
  if (result < 0 && result != AVERROR_EOF) {
    index.ended_early = LibavError(result);
  } else if (format.pb != nullptr && format.pb->error < 0) {
    index.ended_early = LibavError(format.pb->error);
  } else if (index.ended_early.empty() &&
             stream.nb_frames >
                 static_cast<std::int64_t>(index.packets.size()) &&
             !CountsLostFrames(stream, declared, last_dts)) {
    index.ended_early = "its own list names more frames";
  }
  if (!timed) pts.clear();
  std::sort(pts.begin(), pts.end());
  if (!index.ended_early.empty() && last_dts != AV_NOPTS_VALUE) {
    // A later packet, had it been there, would have been decoded after last_dts
    // and shown no earlier: up to there nothing is missing.
    std::erase_if(pts, [&](std::int64_t t) { return t > last_dts; });
    if (timed) index.frames = static_cast<std::int64_t>(pts.size());
  }
  FindRate(pts, stream, declared, index);
  const bool distinct = std::adjacent_find(pts.begin(), pts.end()) == pts.end();
  index.coarse = !distinct;
  if (!distinct) index.spacing.times_s.clear();
  if (timed && distinct) index.pts = std::move(pts);
  FindKeyPackets(index);
  if (index.pts.empty()) {
    index.damaged = std::move(damaged_numbers);
  } else {
    for (const std::int64_t time : damaged) {
      if (const auto frame = index.FindFrame(time)) {
        index.damaged.push_back(*frame);
      }
    }
  }
  return index;
}

bool IsPlaybackRate(double fps) {
  // Frame rates of film and television: a file with one of them may have been
  // recorded faster.
  constexpr double kRates[] = {24000.0 / 1001.0, 24.0, 25.0,
                               30000.0 / 1001.0, 30.0, 50.0,
                               60000.0 / 1001.0, 60.0};
  // Relative: 23.976 counts as 24000/1001, and 24 does, too.
  constexpr double kTolerance = 1e-3;
  return std::any_of(std::begin(kRates), std::end(kRates), [&](double rate) {
    return std::abs(fps / rate - 1.0) <= kTolerance;
  });
}

}  // namespace touchdown::vision
