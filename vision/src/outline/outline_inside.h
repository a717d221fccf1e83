// What lies inside an outline, as far as one frame tells.
#pragma once

#include "touchdown/vision/outline/outline.h"

namespace touchdown::vision {

// kShaded: a quadratic, or one level where the body is too small to show more.
enum class Inside { kShaded, kOneLevel };

// FitOutline with one of them.
core::Expected<OutlineFit> FitOutlineModel(Inside inside,
                                           const core::Frame& frame,
                                           const Background& background,
                                           const Outline& start,
                                           const OutlineOptions& options);

}  // namespace touchdown::vision
