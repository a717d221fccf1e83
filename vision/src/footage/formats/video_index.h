// Every packet of a video stream, so that frames have exact numbers and times:
// made by demuxing the whole file once, without decoding (uncompressed video is
// large: there the container's own list is taken if it is complete).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "footage/formats/frame_spacing.h"
#include "footage/formats/libav.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

struct VideoPacket {
  std::int64_t pts = AV_NOPTS_VALUE;
  std::int64_t dts = AV_NOPTS_VALUE;
  std::int64_t pos = -1;  // byte in the file; -1: not known
  bool key = false;

  // Whether a packet read again is this one. Not by dts: some demuxers guess it
  // from what they read before.
  bool Is(const VideoPacket& other) const {
    const bool same_place = pos < 0 || pos == other.pos;
    return pts == other.pts && same_place && key == other.key &&
           (pts != AV_NOPTS_VALUE || pos >= 0);
  }
};

// From one time of a container to another; damaged files name times whose
// difference does not fit an integer.
double CountTicks(std::int64_t begin, std::int64_t end);

VideoPacket Describe(const AVPacket& packet);

struct VideoIndex {
  std::vector<VideoPacket> packets;  // in the order of the file
  // Presentation times of the frames, ascending, in units of the stream's time
  // base. Empty where the container does not tell them apart (no timestamps, or
  // coarser than the frames): frames are then numbered by counting from the
  // beginning.
  std::vector<std::int64_t> pts;
  std::vector<std::size_t> key_packets;  // of each of pts (FindKeyPacket)
  std::int64_t frames = 0;
  bool coarse = false;                // timestamps that several frames share
  FrameSpacing spacing;               // fps is 0 if the file tells none
  std::vector<std::int64_t> damaged;  // frames known to be, ascending
  std::string ended_early;  // why demuxing stopped before the end, or empty
  // Colours behind the samples, as AV_PKT_DATA_PALETTE: a demuxer gives them
  // with its first packet only. Empty: there are none.
  std::vector<std::uint8_t> palette;

  // Number of the frame shown at `pts`, if there is one.
  std::optional<std::int64_t> FindFrame(std::int64_t pts) const;
  // The last key packet from which frame `index` can be decoded; there are pts.
  std::size_t FindKeyPacket(std::int64_t index) const {
    return key_packets[static_cast<std::size_t>(index)];
  }
  // The first key frame after frame `index`, or the number of frames.
  std::int64_t NextKeyFrame(std::int64_t index) const;
};

// Reads on from the beginning to the end of the file; of uncompressed video
// whose container has a complete list of frames, only that list. `declared` is
// the rate that the container states, or 0/1.
VideoIndex IndexVideo(AVFormatContext& format, AVStream& stream,
                      AVRational declared);

// Whether the rate is one that players use (23.976, 24, 25, 29.97, 30, 50,
// 59.94, 60 within 0.1 %): high-speed recordings are saved with such rates.
bool IsPlaybackRate(double fps);

}  // namespace touchdown::vision
