// The pictures of one contact and the path to it, as data: the pipeline takes
// them from the recording, the report draws them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/report/document.h"
#include "touchdown/core/points.h"

namespace touchdown::report {

// A piece of one frame with what was measured in it, all in px of the recorded
// picture (of the ideal one where a lens was undone).
struct StripPicture {
  std::string label;      // "before: frame 40, 14.3 ms earlier"
  std::string png;        // the bytes of a file
  core::PixelRect piece;  // that it shows; the file may have fewer samples
  std::vector<core::PixelPoint> outline;  // closed
  std::vector<core::PixelPoint> ground;   // two points
  std::vector<core::PixelPoint> before;   // the centre's flights
  std::vector<core::PixelPoint> after;
  std::optional<core::PixelPoint> touching;  // the contact point
};

struct ContactStrip {
  std::vector<StripPicture> pictures;  // before, at and after touchdown
  std::optional<double> px_per_m;      // nothing: the bar is in px
};

// The centre's path and the gap below it, from touchdown.
struct Trajectory {
  std::vector<core::PlanePoint> centre;  // x from where it touched down
  std::vector<double> gap_m;             // of the same samples
};

// The strip as it stands in a page, and its legend in words.
Strip DrawStrip(const ContactStrip& strip, const std::string& caption);
extern const char* const kStripLegend;

}  // namespace touchdown::report
