#include "outline/outline_inside.h"

#include <algorithm>

#include "outline/outline_pixels.h"
#include "outline/track_shape.h"

namespace touchdown::vision {
namespace {

// Half sizes in blurs below which size, blur and shading look alike: where the
// background still holds the body's ghost, most fits with all of them free go
// astray.
constexpr double kNarrow = 4.0;

bool IsAllFree(const OutlineOptions& options) {
  return options.fit_size && options.fit_blur && !options.shading &&
         options.appearance == nullptr;
}

// With one level inside, from a blur that suits such a body. What that explains
// badly, or what is wide after all, is no such body.
core::Expected<OutlineFit> FitNarrow(const core::Frame& frame,
                                     const Background& background,
                                     const Outline& start,
                                     const OutlineOptions& options) {
  constexpr double kLikely = 0.3;  // blur, of the half size
  // Pixels of more than half weight: 0.989 of normal noise. Below, much of the
  // picture is set aside (a hoop's hole).
  constexpr double kNearlyAll = 0.95;
  OutlineOptions blurred = options;
  blurred.blur_px = std::max(options.blur_px, kLikely * SmallestHalf(start));
  auto fit =
      FitOutlineModel(Inside::kOneLevel, frame, background, start, blurred);
  if (fit && fit->misfit < kWellModelled && fit->inliers > kNearlyAll &&
      SmallestHalf(fit->outline) < kNarrow * fit->blur_px) {
    return fit;
  }
  return core::AbsentBecause("no narrow body");
}

}  // namespace

core::Expected<OutlineFit> FitOutline(const core::Frame& frame,
                                      const Background& background,
                                      const Outline& start,
                                      const OutlineOptions& options) {
  auto fit =
      FitOutlineModel(Inside::kShaded, frame, background, start, options);
  if (fit || !IsAllFree(options)) return fit;
  auto narrow = FitNarrow(frame, background, start, options);
  return narrow ? narrow : fit;
}

}  // namespace touchdown::vision
