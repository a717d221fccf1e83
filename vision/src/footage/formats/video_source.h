// Opening a video file with libav, up to its decoder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "footage/formats/libav.h"

namespace touchdown::vision {

class FrameMemory;

struct VideoSource {
  LibavPtr<AVFormatContext> format;
  LibavPtr<AVCodecContext> codec;
  AVStream* stream = nullptr;         // the video, of format
  AVRational declared_rate = {0, 1};  // what the container states
};

// Opens the file at its beginning; sound, subtitles and cover pictures are left
// out. Frames are decoded into `memory` where there is one and it has room, and
// reading and decoding are told to it. Throws core::InputError naming the file.
VideoSource OpenVideoSource(const std::filesystem::path& path,
                            std::int32_t threads,
                            FrameMemory* memory = nullptr);

// "avi", "mp4", "mov", "mkv", "cine" or libav's word for the container.
std::string FormatName(const AVFormatContext& format);

// Whether the file is shorter than the first of its headers says (RIFF, EBML):
// libav takes the end of such a file for the end of the recording.
bool IsCut(const std::filesystem::path& path);

}  // namespace touchdown::vision
