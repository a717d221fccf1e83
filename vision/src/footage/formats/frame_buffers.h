// Frames of libav's decoders in memory of ours.
#pragma once

#include "footage/apart/frame_memory.h"
#include "footage/formats/libav.h"

namespace touchdown::vision {

// From here on the decoder, which is not open yet, writes frames into `memory`
// where it has room, and tells it of each. It must outlive all frames.
void UseFrameMemory(FrameMemory& memory, AVCodecContext& decoder);

}  // namespace touchdown::vision
