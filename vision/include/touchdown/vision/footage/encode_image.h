// Pictures as the bytes of a file, for who shows them.
#pragma once

#include <string>

#include "touchdown/core/frame.h"

namespace touchdown::vision {

// A PNG file as WritePng writes it: the samples themselves.
std::string EncodePng(const core::Frame& frame);

// A JPEG file of a frame of 8 bits; `quality` 1 to 100. A fifth of a PNG's
// size, and not the samples. Throws std::invalid_argument for deeper frames or
// another quality.
std::string EncodeJpeg(const core::Frame& frame, int quality);

}  // namespace touchdown::vision
