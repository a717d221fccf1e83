// One contact in a plane track: the two flights beside it, the instant, the
// ground's height. Pixels and seconds; contact.cc turns them into a record.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "joint_fit.h"
#include "touchdown/vision/contact.h"
#include "touchdown/vision/flight.h"
#include "touchdown/vision/plane_track.h"

namespace touchdown::vision {

struct Event {
  std::size_t begin = 0;  // first sample that may belong to the flight before
  std::size_t first_after = 0;  // samples [begin, first_after) precede the blow
  bool too_few = false;  // frames before the blow, or to tell which they are
  std::size_t end = 0;   // one past the last sample before the next blow

  std::optional<Flight> before;
  std::optional<Flight> after;   // nothing where the body stays down
  std::size_t before_begin = 0;  // samples in the fits
  std::size_t before_end = 0;
  std::size_t after_begin = 0;
  std::size_t after_end = 0;

  std::optional<JointFit> fit;  // of all that follows
  core::Estimate time_s;        // touchdown
  core::Estimate release_s;     // valid with `after`
  double unresolved_s = 0.0;    // half of a contact too short to be seen
  core::Estimate ground_px;     // height of the ground above the line, there
  double disagreement = 0.0;    // sigmas between the flights and the line
};

struct EventOptions {
  FlightOptions flight;
  double flight_sigmas = 4.0;
  double u_line_px = 0.0;    // of the ground line's height at its reference
  double u_slope_rad = 0.0;  // of its direction
};

// Measures the contact between samples[first_after - 1] and
// samples[first_after]; `begin` and `end` bound the frames that may be used.
// False where the flight before cannot be fitted.
bool MeasureEvent(const PlaneTrack& track, Event& event,
                  const EventOptions& options);

// Gap of a flight at an instant, with its rate and uncertainty.
struct FlightGap {
  double gap_px = 0.0;
  double rate = 0.0;  // px/s
  double u_px = 0.0;
};
FlightGap GapOf(const PlaneTrack& track, const Flight& flight, double time_s);

}  // namespace touchdown::vision
