// Outlines of many frames: each from a window of its frame, on several threads.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "outline/track_shape.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/outline/outline.h"

namespace touchdown::vision {

struct OutlineJob {
  std::int64_t frame = 0;
  Outline start;
  core::PixelPoint travel_px{0.0, 0.0};  // as in OutlineOptions
  double turn_rad = 0.0;                 //
};

// FitOutline for each job, in their order; nothing where no outline was found.
// `options` holds for all but for the jobs' own. The result does not depend on
// `threads`. Throws what Clip::Read throws.
std::vector<std::optional<Fitted>> FitOutlines(Clip& clip,
                                               const Background& background,
                                               std::span<const OutlineJob> jobs,
                                               const OutlineOptions& options,
                                               int threads);

// Those that were found.
std::vector<Fitted> Found(const std::vector<std::optional<Fitted>>& fits);

// What a fit from `start` may look at of a clip's picture.
core::PixelRect ChooseWindow(const Outline& start,
                             const OutlineOptions& options,
                             const ClipInfo& info);

}  // namespace touchdown::vision
