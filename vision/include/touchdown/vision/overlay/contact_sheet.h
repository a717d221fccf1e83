// The picture of a contact: a strip of frames around it with what was measured
// drawn in, so that a person sees at a glance whether to believe the number.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "touchdown/vision/contact/contact.h"
#include "touchdown/vision/contact/plane_track.h"
#include "touchdown/vision/footage/clip.h"
#include "touchdown/vision/track/track.h"

namespace touchdown::vision {

struct ContactSheetOptions {
  int columns = 3;
  int rows = 3;
  int panel_px = 360;  // side of one panel in the sheet
  std::string title;   // one line above the panels
};

// 8-bit RGB, rows without padding.
struct ColourImage {
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  std::vector<std::uint8_t> rgb;
};

// Frames before, at and after the first contact (or, where there is none,
// spread over the track), each with the fitted outline (yellow), the ground
// line (cyan), the centre's path (dots), the flights fitted before (green) and
// after (magenta), and in the frame of contact the approach direction. Reads
// those frames of `clip`.
ColourImage DrawContactSheet(Clip& clip, const Track& track,
                             const PlaneTrack& plane,
                             const ContactResult& contacts,
                             const ContactSheetOptions& options = {});

}  // namespace touchdown::vision
