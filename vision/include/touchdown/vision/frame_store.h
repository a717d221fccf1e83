// Keeps what an analysis looks at more than once, so that a compressed clip is
// decoded once however often its frames are looked at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

#include "touchdown/core/points.h"
#include "touchdown/vision/clip.h"

namespace touchdown::vision {

struct FrameStoreOptions {
  // What is kept at most; what does not fit is decoded again when it is wanted
  // again. 192 MiB: of a 1280 x 800 8-bit clip 196 whole frames; the whole
  // program stays under 300 MiB.
  std::size_t most_bytes = std::size_t{192} << 20;

  // Frames [first, last) and the part of the picture that will be looked at;
  // last < 0: to the end, width 0: the whole picture.
  std::int64_t first = 0;
  std::int64_t last = -1;
  core::PixelRect region;

  int threads = 0;  // 0: one for each core; affects speed only

  // Called now and then with the share done, 0..1; may be empty.
  std::function<void(double)> progress;
};

// A clip that hands out the same frames as `clip`. Raw clips, which are mapped
// into memory, are returned as they are. A clip whose pictures all fit is kept
// whole, as it is read. Of a longer one the range is decoded here, once and in
// order (by several readers where each frame is stored alone): the frames that
// a background is made of are kept whole, of the others the windows that differ
// from the still picture (Clip::ChangesIn). The still picture is that of key
// frames, which are decoded first; where it turns out to hold a ghost of the
// body, the range is decoded a second time with the right one. A damaged frame
// ends the pass; reading it says what is wrong.
std::unique_ptr<Clip> KeepFrames(std::unique_ptr<Clip> clip,
                                 const FrameStoreOptions& options = {});

}  // namespace touchdown::vision
