// Keeps decoded frames, so that a compressed clip is decoded once however often
// its frames are looked at.
#pragma once

#include <cstddef>
#include <memory>

#include "touchdown/vision/clip.h"

namespace touchdown::vision {

struct FrameStoreOptions {
  // Frames beyond this are decoded again when they are wanted again. 192 MiB:
  // of a 1280 x 800 8-bit clip 196 frames; the whole program stays under 300
  // MiB.
  std::size_t most_bytes = std::size_t{192} << 20;
};

// A clip that hands out the same frames as `clip`. Raw clips, which are mapped
// into memory, are returned as they are.
std::unique_ptr<Clip> KeepFrames(std::unique_ptr<Clip> clip,
                                 const FrameStoreOptions& options = {});

}  // namespace touchdown::vision
