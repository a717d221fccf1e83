// Touchdown and release: separate ballistic fits before and after, never a
// difference or a smoothing filter across the impact.
//
// Touchdown is the instant at which the gap of the fit before reaches the
// ground, release that at which the gap of the fit after leaves it. Where the
// body was released at once, both fits must meet the same ground: the instant
// and the ground's height are then estimated together, from both fits and from
// what is known of the line (least squares in (t, d)):
//   gap_before(t) = d,  gap_after(t) = d,  d = 0 +- u_ground.
// Where it stays down, the gaps of the frames in contact tell the ground's
// height. Which frames are of which flight a segmentation of the whole path
// tells (path.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "touchdown/calib/plane.h"
#include "touchdown/core/trial.h"
#include "touchdown/core/units.h"
#include "touchdown/vision/contact/flight.h"
#include "touchdown/vision/contact/path.h"
#include "touchdown/vision/contact/plane_track.h"

namespace touchdown::vision {

struct ContactOptions {
  // Nothing: unknown; then gravity is fitted freely, lengths stay absent, and
  // the bounce height is 2 % of the body's size in the image.
  std::optional<calib::Scale> scale;

  // Along the ground's normal. On the ground it lies within 0.35 % of standard
  // gravity (9.764 to 9.834); evenly spread, u = 0.2 %.
  core::Estimate gravity_mps2{core::kStandardGravity_mps2,
                              0.002 * core::kStandardGravity_mps2};

  // The campaign's convention; nothing: the larger of 0.5 mm and 2 % of the
  // body's size.
  std::optional<double> bounce_height_m;

  // A person says so: touchdown lies between this frame and the next that shows
  // the body, whatever else looks like a blow before or beside it. Its instant
  // is still where the flight meets the ground.
  std::optional<std::int64_t> contact_frame;

  // How another result cut the path of the same frames (ContactResult::path);
  // empty: it is cut here. What other numbers (a lens, a yaw, a rate) would
  // change of an answer is a difference of one reading of the clip: where the
  // path was cut anew it could be that of two contacts.
  std::vector<PathStretch> path;

  // As ContactResult::gravity_refuted says; where `path` is given.
  bool gravity_refuted = false;

  // The share of the speed that the air takes on a px of the path.
  double drag_per_px = 0.0;
};

// How one contact was measured; for drawings and tests.
struct ContactEvidence {
  std::optional<Flight> before;
  std::optional<Flight> after;
  double time_s = 0.0;        // touchdown
  double release_s = 0.0;     // = time_s where it was at once
  double ground_px = 0.0;     // height of the ground found here above the line
  double u_ground_px = 0.0;   //
  core::PixelPoint centre;    // at touchdown, in the image
  core::PixelPoint touching;  // the lowest point then, in the image
};

// Of the impacts of a clip that were resolved (a block that chatters strikes
// many times).
struct RestitutionOfImpacts {
  core::Measured value = core::AbsentBecause("no impact was resolved");
  int resolved = 0;
  int unresolved = 0;  // at least so many
};

struct ContactResult {
  core::ContactRecord first;
  std::vector<core::ContactRecord> later;
  RestitutionOfImpacts restitution;
  std::vector<ContactEvidence> evidence;  // of first, then of later
  std::vector<PathStretch> path;          // all of it, by time

  // The body rebounds well above the line, again and again off it, or passes
  // through it: the line is not the ground. Empty where line and track agree.
  std::string ground_refuted;

  // The gravity that the scale tells explains the path less well, by far, than
  // one that each flight may choose: scale or frame rate are wrong. Gravity was
  // fitted freely, and lengths have the u of a scale that is as far off.
  bool gravity_refuted = false;

  // As the flights show it; it may be negative, by noise. Nothing: they are too
  // short to show it, or the path was given.
  std::optional<core::Estimate> drag_per_px;
  std::vector<std::string> warnings;
};

ContactResult FindContacts(const PlaneTrack& track,
                           const ContactOptions& options = {});

// Where no edge is known to be the ground: the line through the lowest point of
// the body at its first rebound, level in the image. Its direction is no better
// known than the camera was levelled: u_level_rad (default 0.5 degrees, a
// camera levelled with care by eye). Nothing where the track shows no rebound,
// or sinks below all of them by the body's size and fewer than three are at one
// level.
std::optional<calib::GroundLine> GroundFromContacts(
    const Track& track, double u_level_rad = 0.5 * core::kDegree);

}  // namespace touchdown::vision
