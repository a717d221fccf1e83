// What general video tools do with the same clip, on the terms that favour
// them: the true ground line, the body's true size and gravity are given.
#pragma once

#include <optional>
#include <vector>

#include "tests/accuracy/design.h"
#include "touchdown/vision/footage/clip.h"

namespace touchdown::accuracy {

enum class Peer {
  kMog2,      // MOG2, centroid of the largest contour, central differences
  kCentroid,  // threshold against the mean of the first frames, centroid,
              // ballistic fits
  kTemplate,  // normalised correlation with a template, parabola through the
              // peak, ballistic fits (as Tracker and Kinovea do)
  kCsrt,      // OpenCV's TrackerCSRT from the true first box, ballistic fits
};
// Those that are built in: CSRT needs libopencv-contrib-dev.
std::vector<Peer> Peers();
const char* Name(Peer peer);

struct PeerReading {
  double approach_rad = 0.0;
  double frame = 0.0;  // of touchdown
};

// Nothing where it finds no touchdown.
std::optional<PeerReading> Measure(vision::Clip& clip, const Case& c,
                                   Peer peer);
// Of the case as it is rendered.
std::optional<PeerReading> Measure(const Case& c, Peer peer);

}  // namespace touchdown::accuracy
