// Frames seen as OpenCV matrices without a copy. Stays inside vision/src.
#pragma once

#include <opencv2/core.hpp>

#include "touchdown/core/frame.h"

namespace touchdown::vision {

// The matrix shares the frame's pixels, which OpenCV must not write.
inline cv::Mat AsMat(const core::Frame& frame) {
  return cv::Mat(frame.height_px, frame.width_px,
                 frame.is_16_bit() ? CV_16UC1 : CV_8UC1,
                 const_cast<std::byte*>(frame.data),
                 static_cast<std::size_t>(frame.stride_bytes));
}

}  // namespace touchdown::vision
