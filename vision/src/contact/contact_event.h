// One contact in a plane track: the two flights beside it, the instant, the
// ground's height. Pixels and seconds; contact_record.cc turns them into a
// record.
#pragma once

#include <optional>
#include <string>

#include "contact/joint_fit.h"
#include "touchdown/vision/contact/flight.h"
#include "touchdown/vision/contact/plane_track.h"

namespace touchdown::vision {

struct Event {
  // Frames of the flight before touchdown, of the flight after release (none
  // where it stays down), and of the supported stretch after touchdown (none
  // where it rebounds). Frames between flights are in contact.
  SampleRange before_frames;
  SampleRange after_frames;
  SampleRange down_frames;

  std::optional<Flight> before;
  std::optional<Flight> after;  // nothing where the body stays down
  std::optional<JointFit> fit;  // of all that follows
  core::Estimate time_s;        // touchdown
  core::Estimate release_s;     // valid with `after`
  double unresolved_s = 0.0;    // half of a contact too short to be seen
  core::Estimate ground_px;     // height of the ground above the line, there
  double disagreement = 0.0;    // sigmas between the flights and the line
};

// Standard deviations, of Event::disagreement: beyond it flights and line
// contradict each other, and the flights are believed. Larger: a line that is
// off biases the instant; smaller: an honest line is dropped (3: in 0.3 % of
// contacts). Not studied.
inline constexpr double kDisagree = 3.0;

// Measures the contact between the flight of `before_frames` and what follows;
// narrows the ranges where frames were exposed across the impact, or lie in a
// soft contact. False, with the reason, where the frames do not determine it.
bool MeasureEvent(const PlaneTrack& track, const FlightOptions& options,
                  Event& event, std::string& reason);

// Frames that determine a flight: two where gravity is known (place and
// velocity), else four (the curvature too, and one to contradict it).
inline std::size_t MinFlightFrames(const FlightOptions& options) {
  return options.gravity_px_per_s2 ? 2 : 4;
}

// Gap of a flight at an instant, with its rate and uncertainty.
struct FlightGap {
  double gap_px = 0.0;
  double rate = 0.0;  // px/s
  double u_px = 0.0;
};
FlightGap GapOfFlight(const PlaneTrack& track, const Flight& flight,
                      double time_s);

// Weighted mean gap of a body that is down, with the u that its scatter and the
// correlation of its poses ask for.
core::Estimate MeanRestingGap(std::span<const PlaneSample> samples);

// A frame whose exposure e goes on for b beyond a blow shows a mean of two
// motions: over the change of velocity it lies off the first by  b^2 / (2 e).
inline double MixtureOffset(double exposure, double beyond) {
  return beyond * beyond / (2.0 * exposure);
}

}  // namespace touchdown::vision
