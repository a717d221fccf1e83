// A small picture of a trial's contact, for the list.
#pragma once

#include <cstdint>

#include "app/review/clip_shelf.h"
#include "touchdown/core/frame.h"
#include "touchdown/core/trial.h"
#include "touchdown/vision/footage/image_file.h"

namespace touchdown::review {

inline constexpr std::int32_t kThumbnailWidth_px = 96;
inline constexpr std::int32_t kThumbnailHeight_px = 72;

// The part of `frame` of `width_px` about `centre` in kThumbnail size, each
// pixel the mean of what it covers; beyond the frame black. `white` is the
// level that is shown as white. Throws std::invalid_argument where the width is
// not positive.
vision::Image Shrunk(const core::Frame& frame, core::PixelPoint centre,
                     double width_px, std::uint32_t white);

// JPEG of the frame of touchdown about the contact point; where the trial has
// none, of the middle of the recording. Throws like ClipShelf::Frame.
Picture RenderThumbnail(ClipShelf& shelf, const core::Trial& trial);

}  // namespace touchdown::review
