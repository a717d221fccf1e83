// The greatest gap after touchdown: of the path fitted between contacts, also
// between frames, and of the frames themselves where no path is known.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "contact/contact_event.h"
#include "contact/motion_segments.h"
#include "touchdown/core/estimate.h"
#include "touchdown/vision/contact/plane_track.h"

namespace touchdown::vision {

// The ground's height above the line near the contact; further along, its u
// grows with that of its direction.
struct GroundLevel {
  double along_px = 0.0;
  core::Estimate height_px;
  double u_slope_rad = 0.0;
};

struct GreatestGap {
  core::Estimate gap_px;   // pose, size and ground in u
  std::int64_t frame = 0;  // nearest to it
  // Where the film ends while it rises: what its flight would reach. The gap
  // above is then that of the last frame.
  std::optional<core::Estimate> reaches_px;
};

// Over the samples from `from` on. `event`: the contact before them, whose
// flight after release is known best; null: none. Nothing without samples.
std::optional<GreatestGap> FindGreatestGap(const PlaneTrack& track,
                                           std::span<const Stretch> stretches,
                                           std::size_t from,
                                           const GroundLevel& ground,
                                           const FlightOptions& options,
                                           const Event* event);

}  // namespace touchdown::vision
