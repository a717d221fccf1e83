// Which frames of a compressed clip need not be decoded: those between glimpses
// that show nothing. Mapped clips are glimpsed at by first_look.h.
#pragma once

#include <cstdint>
#include <vector>

#include "touchdown/vision/footage/clip.h"

namespace touchdown::vision {

struct GlimpseRule {
  // Frames between two glimpses that are farther apart are decoded, whatever
  // those show: a body may pass between them. 32: as for mapped clips.
  std::int64_t most_between = 32;

  // Frames next to a glimpse that shows something: up to the glimpses before
  // and after it, and at least so many. 32: what is only partly in the picture
  // is too faint for a glimpse for that long if it is slow.
  std::int64_t reach = 32;
};

// Of a clip whose frames are stored alone one frame in so many is glimpsed at.
// 16: a sixteenth is decoded before it is known where the body is, and what is
// in the picture for 32 frames is seen twice.
inline constexpr std::int64_t kGlimpseStride = 16;

// Whether a frame and the next one differ from the still picture at the same
// place, or next to it: noise of compression hardly does, and what moves by
// less than two cells of the scout a frame does. `margin_cells` as the scout
// had it.
bool AreInBoth(const Changes& changes, const Changes& next,
               std::int32_t margin_cells);

// Those of [first, last) that are worth decoding, ascending, given which of the
// `glimpsed` frames show something. All, where none does.
std::vector<std::int64_t> FramesWorthDecoding(
    std::int64_t first, std::int64_t last,
    const std::vector<std::int64_t>& glimpsed, const std::vector<bool>& shows,
    const GlimpseRule& rule = {});

}  // namespace touchdown::vision
