// The colour differences of decoded video frames (Cb, Cr), upright and brought
// to the size of the luma: where body and shadow are equally bright, colour
// still tells them apart.
#pragma once

#include <cstdint>
#include <vector>

#include "footage/formats/libav.h"
#include "footage/formats/luma.h"
#include "touchdown/core/frame.h"
#include "touchdown/core/points.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

class ChromaReader {
 public:
  // Planar 8-bit YUV with two chroma planes, of any subsampling.
  static bool Reads(AVPixelFormat format);

  // `channel` is kBlueDifference or kRedDifference.
  ChromaReader(AVPixelFormat format, Orientation orientation, Channel channel);

  // A window in coordinates as shown, bilinear between chroma samples, which
  // lie where the frame says (left or centre of the luma samples they stand
  // for). Valid until the next View.
  core::Frame View(const AVFrame& frame, const core::PixelRect& window);

 private:
  AVPixelFormat format_;
  Orientation orientation_;
  int component_;
  std::vector<std::uint8_t> buffer_;
};

}  // namespace touchdown::vision
