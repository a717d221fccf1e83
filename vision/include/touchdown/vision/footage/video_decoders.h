// Which kinds of video the libav of this machine decodes.
#pragma once

#include <string>
#include <vector>

namespace touchdown::vision {

struct VideoDecoder {
  std::string name;  // as libav calls it: "h264"
  bool is_there = false;
};

// Those that cameras and their programs write. Throws core::InputError where
// libav is not installed, or is of another version than was compiled for.
std::vector<VideoDecoder> VideoDecoders();

}  // namespace touchdown::vision
