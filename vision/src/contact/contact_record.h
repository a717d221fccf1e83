// From a measured contact, in pixels, to the record of a trial, in SI units.
#pragma once

#include <string>
#include <vector>

#include "contact/contact_event.h"
#include "contact/motion_segments.h"
#include "touchdown/core/trial.h"
#include "touchdown/vision/contact/contact.h"

namespace touchdown::vision {

struct RecordContext {
  const PlaneTrack& track;
  // The same, with the u that flights of any gravity ask for.
  const PlaneTrack& freely_seen;
  const ContactOptions& options;
  FlightOptions flight;
  const std::vector<Stretch>& stretches;
  // Of neighbouring poses together, in place and attitude.
  double u_common_place_px = 0.0;
  double u_common_face_rad = 0.0;
  // Of the scale, relative, beyond its own u: what the flights' gravity says
  // against it.
  double scale_doubt = 0.0;
  // px/frame^2. The same doubt where not the scale but the places err: what
  // they bend the path by along the ground's normal.
  double bend_px = 0.0;
};

core::ContactRecord MakeRecord(const RecordContext& context, const Event& event,
                               std::vector<std::string>& warnings);

// A body that is on the ground from the first frame, `down`: approach angle 0.
// Of one that turns meanwhile no angle of the touchdown is known.
// `slope` is the inclination of its path to the ground line that was taken out.
core::ContactRecord RecordFromStart(const RecordContext& context,
                                    const Stretch& down, double slope_rad);

}  // namespace touchdown::vision
