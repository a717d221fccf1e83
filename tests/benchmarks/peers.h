// What general video tools do with the same clip, on the terms that favour
// them: the true ground line, the body's true size and gravity are given.
#pragma once

#include <optional>

#include "tests/accuracy/design.h"

namespace touchdown::accuracy {

enum class Peer {
  kMog2,      // MOG2, centroid of the largest contour, central differences
  kCentroid,  // threshold against the mean of the first frames, centroid,
              // ballistic fits
  kTemplate,  // normalised correlation with a template, parabola through the
              // peak, ballistic fits (as Tracker and Kinovea do)
};
inline constexpr Peer kPeers[] = {Peer::kMog2, Peer::kCentroid,
                                  Peer::kTemplate};
const char* Name(Peer peer);

struct PeerReading {
  double approach_rad = 0.0;
  double frame = 0.0;  // of touchdown
};

// Nothing where it finds no touchdown.
std::optional<PeerReading> Measure(const Case& c, Peer peer);

}  // namespace touchdown::accuracy
