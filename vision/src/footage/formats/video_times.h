// When the frames of a video were taken: by the container, by the camera's own
// header of a .cine, or by the user's rate.
#pragma once

#include <cstdint>
#include <filesystem>

#include "footage/formats/video_index.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

// The camera's own numbers and times, which libav leaves out: the number of the
// first image into `info`, the spacing of the frames into `index`, and what is
// odd about them into the warnings. Returns whether samples are packed 10-bit
// ones, which are companded. Throws core::InputError as ReadCineHeader.
bool TakeCineHeader(const std::filesystem::path& path,
                    const ClipOptions& options, VideoIndex& index,
                    ClipInfo& info);

// Rate, source and trust into `info`, with warnings. Throws core::InputError
// where neither the file nor the user tells a rate.
void SetTimeBase(const VideoIndex& index, const ClipOptions& options,
                 ClipInfo& info);

// Time of a frame from frame 0, in seconds.
double FrameTime(const VideoIndex& index, const TimeBase& time,
                 std::int64_t frame);

}  // namespace touchdown::vision
