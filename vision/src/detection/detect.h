// Coarse detection: which connected regions of a frame could be the body. Good
// to a pixel or two; outline.h does the measuring.
#pragma once

#include <vector>

#include "touchdown/core/frame.h"
#include "touchdown/vision/background/background.h"
#include "touchdown/vision/outline/outline.h"

namespace touchdown::vision {

// A region that differs from what surrounds it.
struct Blob {
  core::PixelPoint centre;
  double area_px2 = 0.0;     // holes filled
  double contrast_dn = 0.0;  // region minus background, signed; kChange: its
                             // magnitude
  double long_px = 0.0;      // sides of the smallest box around it
  double short_px = 0.0;     //
  double angle_rad = 0.0;    // of the box's long side, image
  double fill = 0.0;         // area over area of that box
  bool at_border = false;    // touches the edge of the picture or region
};

enum class Detector {
  kDifference,  // frame against the background
  kChange,      // the same, but all that differs, whichever way: of a body of
                // several levels, or before a background of several, no part
                // is the strongest all along. Shadows come with it.
  kLevels       // the frame's own two levels, where the background is not seen
};

struct DetectOptions {
  Detector detector = Detector::kDifference;
  core::PixelRect region;  // searched; whole picture by default (width 0)

  // The frame's differences over the background's noise (Changes::noise).
  double noise = 1.0;

  // A region must differ by this many standard deviations of the smoothed
  // difference. 6: one false pixel in 1e9, none in a clip.
  double threshold_sigmas = 6.0;

  // Within a region, what differs by less than this share of its strongest
  // difference is cut away: shadows (a soft shadow has about half the contrast
  // of a body) and the blurred rim. 0.55 cuts close to the half level of the
  // edge.
  double share_of_peak = 0.55;

  double least_area_px2 = 12.0;  // smaller regions are noise or dust
  int most_blobs = 12;           // the largest ones are kept
};

// By which blobs are ranked: area times contrast.
double Strength(const Blob& blob);

// `frame` may be a window of the picture.
std::vector<Blob> DetectBlobs(const core::Frame& frame,
                              const Background& background,
                              const DetectOptions& options);

// The strongest ones (area times contrast), options.most_blobs of them.
void KeepLargest(std::vector<Blob>& blobs, const DetectOptions& options);

// Start of the outline's fit for a body of `kind`.
Outline MakeStart(const Blob& blob, core::BodyKind kind);

}  // namespace touchdown::vision
