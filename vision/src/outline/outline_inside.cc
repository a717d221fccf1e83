#include "outline/outline_inside.h"

#include <algorithm>

#include "outline/outline_pixels.h"
#include "outline/track_shape.h"

namespace touchdown::vision {
namespace {

// Half size in blurs, below which size, blur and shading look alike: where the
// background still holds the body's ghost, most fits with all of them free go
// astray. Larger sends ordinary bodies here. Set with 40 rendered clips at a
// blur of 4 px and a body of 24 px: none was absent then, 12 before.
constexpr double kNarrowBlurs = 4.0;

// Whether nothing that other frames tell holds the fit.
bool IsAllFree(const OutlineOptions& options) {
  return options.fit_size && options.fit_blur && !options.shading &&
         options.appearance == nullptr;
}

// Fits a body that is hardly wider than its blur: one level inside, and a start
// from a blur that suits it. What that explains badly, or what turns out wide,
// is no such body.
core::Expected<OutlineFit> FitNarrow(const core::Frame& frame,
                                     const Background& background,
                                     const Outline& start,
                                     const OutlineOptions& options) {
  // Start of the blur, as a share of the half size. Set with the same clips.
  constexpr double kStartBlur = 0.3;
  // Share of the pixels of more than half weight: 0.989 of normal noise. Below
  // it much of the picture is set aside (a hoop's hole), and the model is
  // wrong. Not studied.
  constexpr double kMinInliers = 0.95;
  OutlineOptions blurred = options;
  blurred.blur_px = std::max(options.blur_px, kStartBlur * SmallestHalf(start));
  auto fit =
      FitOutlineModel(Inside::kOneLevel, frame, background, start, blurred);
  if (fit && fit->misfit < kWellModelled && fit->inliers > kMinInliers &&
      SmallestHalf(fit->outline) < kNarrowBlurs * fit->blur_px) {
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
