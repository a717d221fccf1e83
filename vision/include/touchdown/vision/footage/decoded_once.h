// A clip that remembers the frames that it decoded: those who look at light and
// camera before the body is looked for read the same ones.
#pragma once

#include <cstddef>
#include <memory>

#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

struct DecodedOnceOptions {
  // Bytes of frames that are kept: the first to be read. 32 MiB: 131 frames of
  // 640x400 pixels of 8 bits, which is more than light and camera look at. More
  // saves nothing in longer clips, of which they look at no more; fewer decode
  // twice.
  std::size_t most_bytes = std::size_t{32} << 20U;
  // Where it is there: nothing more is kept once it is false, so that what is
  // decoded afterwards does not hang on the order in which it is read.
  std::shared_ptr<const bool> looks;
};

// The clip itself where its windows are cheap: nothing is decoded there. Frames
// are kept until the clip ends.
std::unique_ptr<Clip> DecodeOnce(std::unique_ptr<Clip> clip,
                                 const DecodedOnceOptions& options = {});

}  // namespace touchdown::vision
